# STEP and IGES through OpenCASCADE: an optional part of the mesh layer.
find_package(OpenCASCADE QUIET)
if(NOT OpenCASCADE_FOUND)
  message(STATUS "OpenCASCADE not found: STEP and IGES files will be refused")
  return()
endif()

# The toolkits are named as files: the package's targets drag in its debug settings and its viewer.
set(step_toolkits)
foreach(toolkit TKSTEP TKIGES TKXSBase TKMesh TKShHealing TKTopAlgo TKBRep TKG3d TKMath TKernel)
  list(APPEND step_toolkits ${OpenCASCADE_LIBRARY_DIR}/lib${toolkit}.so)
endforeach()
target_sources(isopath_mesh PRIVATE ${CMAKE_SOURCE_DIR}/src/isopath/mesh/step/tessellate.cpp)
target_compile_definitions(isopath_mesh PRIVATE ISOPATH_HAS_STEP)
target_include_directories(isopath_mesh SYSTEM PRIVATE ${OpenCASCADE_INCLUDE_DIR})
target_link_libraries(isopath_mesh PRIVATE ${step_toolkits})
