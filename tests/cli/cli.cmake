# The program, run as a process.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  add_test(NAME cli COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/cli_test.py $<TARGET_FILE:isopath_app>
                            check,contours,export,field,plan)
  set_tests_properties(cli PROPERTIES TIMEOUT 600 LABELS cli)
endif()
