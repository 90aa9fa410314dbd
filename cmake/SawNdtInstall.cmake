include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/saw_ndt)
# A file of targets for each component, so that find_package() reads those that are asked for, and what they need, alone.
install(TARGETS saw_ndt EXPORT saw_ndt_pcl_targets)
foreach(component ${SAW_NDT_COMPONENTS})
  install(TARGETS saw_ndt_${component} EXPORT saw_ndt_${component}_targets
          RUNTIME COMPONENT runtime LIBRARY COMPONENT runtime NAMELINK_COMPONENT development
          ARCHIVE COMPONENT development)
  install(EXPORT saw_ndt_${component}_targets NAMESPACE saw_ndt:: FILE saw_ndt_${component}-targets.cmake
          DESTINATION ${package_dir} COMPONENT development)
endforeach()
install(DIRECTORY include/saw_ndt ${PROJECT_BINARY_DIR}/include/saw_ndt DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT development FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
configure_package_config_file(cmake/saw_ndt-config.cmake.in saw_ndt-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(saw_ndt-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/saw_ndt-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/saw_ndt-config-version.cmake
        DESTINATION ${package_dir} COMPONENT development)
