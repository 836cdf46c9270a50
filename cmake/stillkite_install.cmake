# cmake --install: headers as include/stillkite/<module>/, the libraries, and a package that
# find_package(stillkite) finds. Every module is stillkite::<module>; stillkite::stillkite is all.
include(CMakePackageConfigHelpers)

add_library(stillkite_all INTERFACE)
add_library(stillkite::stillkite ALIAS stillkite_all)
set_target_properties(stillkite_all PROPERTIES EXPORT_NAME stillkite)

foreach(module IN LISTS STILLKITE_MODULES)
  if(NOT TARGET stillkite_${module})
    continue()
  endif()
  target_link_libraries(stillkite_all INTERFACE stillkite_${module})
  install(TARGETS stillkite_${module} EXPORT stillkite)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${module}
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stillkite FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(TARGETS stillkite_all EXPORT stillkite)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/stillkite)
install(EXPORT stillkite NAMESPACE stillkite:: FILE stillkite-targets.cmake
        DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/stillkite-config.cmake.in
                              ${PROJECT_BINARY_DIR}/stillkite-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stillkite-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stillkite-config.cmake
              ${PROJECT_BINARY_DIR}/stillkite-config-version.cmake
        DESTINATION ${package_dir})
