# STEP and IGES through OpenCASCADE: an optional part of the mesh layer.
find_package(OpenCASCADE QUIET)
if(NOT OpenCASCADE_FOUND)
  message(STATUS "OpenCASCADE not found: STEP and IGES files will be refused")
  return()
endif()
