# The viewer inside the report: bundled from web/ with esbuild, laid into the post layer by the assembler.

find_program(NODE_PROGRAM NAMES node nodejs)
find_program(NPM_PROGRAM npm)
if(NOT NODE_PROGRAM OR NOT NPM_PROGRAM)
  message(FATAL_ERROR "isopath's report needs Node.js 18 or newer and npm to build its viewer. Run './dev setup', or install the packages nodejs and npm.")
endif()

set(web_dir ${CMAKE_SOURCE_DIR}/web)
set(viewer_dir ${CMAKE_BINARY_DIR}/viewer)
set(viewer_files ${viewer_dir}/report.html ${viewer_dir}/viewer.css ${viewer_dir}/viewer.js)
file(GLOB viewer_sources CONFIGURE_DEPENDS ${web_dir}/src/*)

# The packages are shared by all build folders, so each keeps only a stamp of having seen them current.
add_custom_command(
  OUTPUT ${viewer_dir}/packages.stamp
  COMMAND ${CMAKE_COMMAND} -DWEB_DIR=${web_dir} -DNPM=${NPM_PROGRAM} -P ${CMAKE_SOURCE_DIR}/cmake/NpmInstall.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${viewer_dir}/packages.stamp
  DEPENDS ${web_dir}/package.json ${web_dir}/package-lock.json ${CMAKE_SOURCE_DIR}/cmake/NpmInstall.cmake
  COMMENT "Checking the viewer's npm packages" VERBATIM)
add_custom_command(
  OUTPUT ${viewer_files}
  COMMAND ${NODE_PROGRAM} build.mjs ${viewer_dir}
  WORKING_DIRECTORY ${web_dir}
  DEPENDS ${viewer_dir}/packages.stamp ${web_dir}/build.mjs ${viewer_sources}
  COMMENT "Bundling the viewer" VERBATIM)

configure_file(${CMAKE_SOURCE_DIR}/cmake/viewer_assets.S.in ${viewer_dir}/assets.S @ONLY)
add_library(isopath_viewer_assets OBJECT ${viewer_dir}/assets.S ${viewer_files})
set_source_files_properties(${viewer_dir}/assets.S PROPERTIES OBJECT_DEPENDS "${viewer_files}")
target_sources(isopath_post PRIVATE $<TARGET_OBJECTS:isopath_viewer_assets>)
