include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/saw_ndt)
install(TARGETS saw_ndt EXPORT saw_ndt_targets)
# The simulator is no part of the library.
install(DIRECTORY include/saw_ndt DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} PATTERN simulation EXCLUDE)
install(EXPORT saw_ndt_targets NAMESPACE saw_ndt:: FILE saw_ndt-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(cmake/saw_ndt-config.cmake.in saw_ndt-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(saw_ndt-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/saw_ndt-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/saw_ndt-config-version.cmake
        DESTINATION ${package_dir})
