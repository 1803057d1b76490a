# LinuxCNC's own interpreter reproduces the programs that post writes. Skipped where its package cannot be downloaded.
find_package(Python3 COMPONENTS Interpreter)
if(NOT Python3_FOUND)
  message(STATUS "Python 3 not found: programs are not checked with LinuxCNC")
  return()
endif()

add_executable(write_programs post/programs/write_programs.cpp)
target_include_directories(write_programs PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(write_programs PRIVATE isopath_flags isopath::post)
isopath_use_pch(write_programs)

set(programs ${CMAKE_CURRENT_BINARY_DIR}/programs)
add_test(NAME linuxcnc.write_programs COMMAND write_programs ${programs})
set_tests_properties(linuxcnc.write_programs PROPERTIES FIXTURES_SETUP linuxcnc_programs)
foreach(name zigzag_3_axes zigzag_5_axes helix_5_axes near_pole_5_axes spiral_5_axes)
  add_test(NAME linuxcnc.${name} COMMAND Python3::Interpreter ${CMAKE_SOURCE_DIR}/tools/check_gcode.py ${programs}/${name}.ngc
                                         ${programs}/${name}.csv --cache ${CMAKE_BINARY_DIR}/../linuxcnc)
  set_tests_properties(linuxcnc.${name} PROPERTIES FIXTURES_REQUIRED linuxcnc_programs SKIP_RETURN_CODE 77 TIMEOUT 600
                                                   RESOURCE_LOCK linuxcnc)
endforeach()
