# How every target of isopath is compiled, and what a layer is.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # Precompiled headers carry no useful time stamps; the base folder lets two checkouts share results.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
                                  CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE_PROGRAM})
endif()

add_library(isopath_flags INTERFACE)
target_compile_options(isopath_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 reports phantom reads in inlined Eigen and std::vector code at -O3.
  target_compile_options(isopath_flags INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
                                                 -fpch-preprocess)
endif()
# Position independent everywhere, spelled the same for libraries and programs so that they share one precompiled header.
target_compile_options(isopath_flags INTERFACE -fPIC)
# Results must not depend on whether the processor fuses a multiply and an add.
target_compile_options(isopath_flags INTERFACE -ffp-contract=off)
if(ISOPATH_SANITIZE)
  target_compile_options(isopath_flags INTERFACE -fsanitize=${ISOPATH_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(isopath_flags INTERFACE -fsanitize=${ISOPATH_SANITIZE})
endif()

# isopath_use_pch(target [NAME pch] [HEADERS ...] [LINKS ...]): the precompiled header <pch>, made on first use from the
# standard library, Eigen and fmt, and from HEADERS, for which it links LINKS. All layers share the one without a NAME.
function(isopath_use_pch target)
  if(NOT ISOPATH_PCH)
    return()
  endif()
  cmake_parse_arguments(PCH "" "NAME" "HEADERS;LINKS" ${ARGN})
  if(NOT PCH_NAME)
    set(PCH_NAME isopath_pch)
  endif()
  if(NOT TARGET ${PCH_NAME})
    file(WRITE ${CMAKE_BINARY_DIR}/${PCH_NAME}.cpp "")
    add_library(${PCH_NAME} OBJECT ${CMAKE_BINARY_DIR}/${PCH_NAME}.cpp)
    target_link_libraries(${PCH_NAME} PRIVATE isopath_flags Eigen3::Eigen fmt::fmt ${PCH_LINKS})
    target_compile_options(${PCH_NAME} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_OPTIONS>)
    target_precompile_headers(${PCH_NAME} PRIVATE ${CMAKE_SOURCE_DIR}/cmake/pch.h ${PCH_HEADERS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${PCH_NAME})
endfunction()

# For programs that compile long and run short, where optimised argument parsing and test cases gain nobody anything.
function(isopath_compile_fast target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# isopath_layer(name LINKS ... [PRIVATE ...]): the static library of src/isopath/<name>.
# Its headers are reached through a folder of their own, so that including a layer one does not link fails to compile.
function(isopath_layer name)
  cmake_parse_arguments(LAYER "" "" "LINKS;PRIVATE" ${ARGN})
  set(source_dir ${CMAKE_SOURCE_DIR}/src/isopath/${name})
  set(include_dir ${CMAKE_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${include_dir}/isopath)
  file(CREATE_LINK ${source_dir} ${include_dir}/isopath/${name} SYMBOLIC)
  file(GLOB sources CONFIGURE_DEPENDS ${source_dir}/*.cpp)
  add_library(isopath_${name} STATIC ${sources})
  add_library(isopath::${name} ALIAS isopath_${name})
  target_include_directories(isopath_${name} PUBLIC ${include_dir})
  target_link_libraries(isopath_${name} PUBLIC ${LAYER_LINKS} PRIVATE isopath_flags ${LAYER_PRIVATE})
  isopath_use_pch(isopath_${name})
endfunction()
