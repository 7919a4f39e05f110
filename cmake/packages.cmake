# SPDX-License-Identifier: LGPL-2.1-or-later
# Debian packages: cpack -G DEB in a build tree, or scripts/package.
set(packages library components development tools)
# The library's name carries the soname, so that programs keep the release that they were built against when another comes.
set(soname_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libhexaplast${soname_version})
set(CPACK_DEBIAN_COMPONENTS_PACKAGE_NAME hexaplast-components)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libhexaplast-dev)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME hexaplast-tools)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Libraries for programs that use the core, the scene graph or the files of runs.")
set(CPACK_COMPONENT_COMPONENTS_DESCRIPTION "The stock components of scenes, as the plugin that the command and Python load.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "What programs and plugins are built with: headers, CMake and pkg-config files.")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The hexaplast command, its pictures, its window and its studies.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_COMPONENTS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS library)
set(CPACK_COMPONENT_COMPONENTS_DEPENDS library)
set(CPACK_COMPONENT_TOOLS_DEPENDS library components)
# The trigger is how Debian wants the linker's cache renewed. CPack would call ldconfig from scripts of its own as well, unless
# it is told of others; names without a file are told, noted with a warning, and not packed.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/triggers
    ${PROJECT_BINARY_DIR}/none/postinst ${PROJECT_BINARY_DIR}/none/postrm)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS
    "fonts-dejavu-core, python3, python3-numpy, python3-scipy, python3-h5py, python3-matplotlib")

if(TARGET hexaplast_python)
  list(APPEND packages python)
  execute_process(COMMAND ${HEXAPLAST_PYTHON} -c "import sys; print('%d.%d' % sys.version_info[:2])"
                  OUTPUT_VARIABLE python_version OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${HEXAPLAST_PYTHON} -c "import sys; print('%d.%d' % (sys.version_info[0], sys.version_info[1] + 1))"
                  OUTPUT_VARIABLE python_next_version OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-hexaplast)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python module: bodies and scenes, with numpy arrays.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_COMPONENT_PYTHON_DEPENDS library components)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${python_version}), python3 (<< ${python_next_version}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS hexaplast-tools)  # which hexaplast.study calls
endif()

# Debian's tools read a changelog of their own form; ours goes beside it.
set(maintainer "Hexaplast maintainers <maintainers@hexaplast.invalid>")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is given
file(WRITE ${PROJECT_BINARY_DIR}/changelog "hexaplast (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
     "  * What has changed is in CHANGELOG.md.gz.\n\n -- ${maintainer}  ${date}\n")
execute_process(COMMAND gzip -9nc ${PROJECT_BINARY_DIR}/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz)
execute_process(COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${PROJECT_BINARY_DIR}/CHANGELOG.md.gz)

install(FILES ${CMAKE_CURRENT_LIST_DIR}/lintian_overrides COMPONENT components
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${CPACK_DEBIAN_COMPONENTS_PACKAGE_NAME})
foreach(package IN LISTS packages)
  string(TOUPPER ${package} upper)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright ${PROJECT_BINARY_DIR}/changelog.gz ${PROJECT_BINARY_DIR}/CHANGELOG.md.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} COMPONENT ${package})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
endforeach()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)  # headers alone

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${packages})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")  # a program runs with later releases of the same soname too
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGE_NAME hexaplast)
set(CPACK_PACKAGE_VENDOR "Hexaplast")
set(CPACK_PACKAGE_CONTACT "${maintainer}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
include(CPack)
