# The viewer's own tests, and the report as a browser sees it.
add_executable(isopath_report_sample ${CMAKE_CURRENT_SOURCE_DIR}/post/sample/report_sample.cpp)
target_link_libraries(isopath_report_sample PRIVATE isopath_flags isopath::post)
isopath_use_pch(isopath_report_sample)

add_test(NAME viewer_unit COMMAND ${NODE_PROGRAM} --test WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}/web)
set_tests_properties(viewer_unit PROPERTIES TIMEOUT 120)
add_test(NAME report_browser COMMAND ${NODE_PROGRAM} --test ${CMAKE_CURRENT_SOURCE_DIR}/post/report_browser.test.mjs)
set_tests_properties(report_browser PROPERTIES TIMEOUT 600 ENVIRONMENT "ISOPATH_REPORT_SAMPLE=$<TARGET_FILE:isopath_report_sample>")
