# SPDX-License-Identifier: LGPL-2.1-or-later
# Headers that are never installed, for this tree's own libraries and programs: those of src as "module/file.hpp", and
# "formats/file.hpp". The plugin of SOFA does not link it, as it is built outside this tree too.
add_library(hexaplast_internal INTERFACE)
target_include_directories(hexaplast_internal INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})

# Makes a target one of the shared libraries that are installed. `hexaplast_module` is found as Hexaplast::module.
#
# hexaplast_library(TARGET [FILES file...] [PUBLIC target...] [PRIVATE target...])
function(hexaplast_library target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "FILES;PUBLIC;PRIVATE")
  string(REPLACE hexaplast_ "" module ${target})
  add_library(${target} SHARED ${arg_FILES})
  add_library(Hexaplast::${module} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${module} VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    INSTALL_RPATH "$ORIGIN")
  target_link_options(${target} PRIVATE -Wl,--no-undefined)
  target_compile_options(${target} PRIVATE $<$<BOOL:${HEXAPLAST_FUZZ}>:-fsanitize=fuzzer-no-link>)  # libFuzzer sees their lines
  target_link_libraries(${target}
    PUBLIC ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:hexaplast_flags> $<BUILD_INTERFACE:hexaplast_internal> fmt::fmt ${arg_PRIVATE})
  install(TARGETS ${target} EXPORT HexaplastTargets
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT development)
endfunction()

# hexaplast_plugin_headers(TARGET module...): the headers of modules of plugin/, which are included as "module/file.hpp". One
# is not installed: it needs a header of src.
function(hexaplast_plugin_headers target)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/plugin> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hexaplast/plugin>)
  foreach(module IN LISTS ARGN)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/plugin/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hexaplast/plugin
            COMPONENT development FILES_MATCHING PATTERN "*.hpp" PATTERN "dense_body.hpp" EXCLUDE)
  endforeach()
endfunction()
