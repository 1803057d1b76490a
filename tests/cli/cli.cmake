# The program, run as a process. Sanitizers make it slower than its promises.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  set(slowness 1)
  if(ISOPATH_SANITIZE)
    set(slowness 6)
  endif()
  add_test(NAME cli COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/cli_test.py $<TARGET_FILE:isopath_app>
                            check,contours,export,field,medial-axis,plan ${slowness})
  set_tests_properties(cli PROPERTIES TIMEOUT 600 LABELS cli RUN_SERIAL TRUE)
endif()
