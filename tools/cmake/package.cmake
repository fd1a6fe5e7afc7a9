# Files that `cmake --install` copies, and the Debian package that `cpack -G DEB` makes from them.
include(GNUInstallDirs)
# Only the program with its pages and the library (tools/cmake/library.cmake) are installed: tests need not be built.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)

# The program prints its own manual page, from its table of options.
set(man_page "${PROJECT_BINARY_DIR}/epcont.1")
add_custom_command(TARGET epcont POST_BUILD COMMAND epcont --man > "${man_page}" BYPRODUCTS "${man_page}" VERBATIM)

install(TARGETS epcont RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(FILES "${man_page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
file(GLOB manual "${PROJECT_SOURCE_DIR}/input/*.md")
install(FILES ${manual} DESTINATION "${CMAKE_INSTALL_DOCDIR}/input")   # where README.md expects them
# The place that Debian requires; with the notices of statically linked libraries.
set(copyright LICENSE)
if(is_static)
  list(APPEND copyright tools/cmake/openblas.txt)
endif()
execute_process(COMMAND "${CMAKE_COMMAND}" -E cat ${copyright} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
  OUTPUT_FILE "${PROJECT_BINARY_DIR}/copyright" COMMAND_ERROR_IS_FATAL ANY)
install(FILES "${PROJECT_BINARY_DIR}/copyright" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(FILES input/hertz/hertz44.dat DESTINATION "${CMAKE_INSTALL_DOCDIR}/examples")

set(CPACK_GENERATOR DEB)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};Unspecified;/")   # the program, not the library
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "elastoplastic contact of plane bodies and rings")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"From decks of NASTRAN bulk data: what touches, with what force, how far the
bodies approach and where they have yielded. Contact is exact to rounding, and
every answer is certified by code of its own.")
set(CPACK_PACKAGE_CONTACT "The epcont authors" CACHE STRING "Whom the package names as its maintainer: NAME <ADDRESS>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)   # packages of the linked shared libraries
# Folders are readable for all users, whatever the umask of the packager.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/tools/cmake/compress.cmake")
include(CPack)
