# The library for other programs, an install component of its own ("development"): the archive, the module `epcont` and
# the files of find_package(epcont). A .mod file of gfortran contains all that it uses from other modules.
include(CMakePackageConfigHelpers)
set(modules "${CMAKE_INSTALL_LIBDIR}/fortran/epcont")
set(config "${CMAKE_INSTALL_LIBDIR}/cmake/epcont")
set_target_properties(epcont_library PROPERTIES EXPORT_NAME library)
target_include_directories(epcont_library INTERFACE "$<INSTALL_INTERFACE:${modules}>")
install(TARGETS epcont_library EXPORT epcont ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
install(FILES "${PROJECT_BINARY_DIR}/modules/epcont.mod" DESTINATION "${modules}" COMPONENT development)
install(EXPORT epcont NAMESPACE epcont:: FILE epcontTargets.cmake DESTINATION "${config}" COMPONENT development)
configure_package_config_file(tools/cmake/epcontConfig.cmake.in "${PROJECT_BINARY_DIR}/epcontConfig.cmake" INSTALL_DESTINATION "${config}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/epcontConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/epcontConfig.cmake" "${PROJECT_BINARY_DIR}/epcontConfigVersion.cmake" DESTINATION "${config}"
  COMPONENT development)
install(DIRECTORY input/library DESTINATION "${CMAKE_INSTALL_DOCDIR}/examples" COMPONENT development)
