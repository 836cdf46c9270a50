# cmake --install: the public header with the headers that it includes, the libraries that it needs,
# and a package that find_package(stillkite) finds: target stillkite::stillkite.
include(CMakePackageConfigHelpers)

# Headers that stillkite/stillkite.hpp includes; the tests InstallList compare the list.
set(STILLKITE_INCLUDED_HEADERS
  estimation/ego_motion/kalman_filter_config.hpp
  estimation/ego_motion/least_squares_config.hpp
  estimation/ego_motion/motion_filter_config.hpp
  estimation/fusion/fusion_config.hpp
  estimation/motion_estimate.hpp
  estimation/plane/levelling_config.hpp
  estimation/plane/plane_alignment_config.hpp
  estimation/robust_kernel.hpp
  estimation/twist.hpp
  estimation/two_view/opencv_pose_config.hpp
  estimation/two_view/relative_pose.hpp
  estimation/two_view/relative_pose_config.hpp
  estimation/two_view/rotation_gate_config.hpp
  estimation/verdict.hpp
  flow/dense_lucas_kanade_config.hpp
  flow/detector_config.hpp
  flow/feature_tracker_config.hpp
  flow/tile_grid.hpp
  geometry/angle.hpp
  geometry/camera.hpp
  geometry/fields.hpp
  geometry/frame_period.hpp
  geometry/image_view.hpp
  geometry/median.hpp
  geometry/rigid_transform.hpp
  geometry/stamp_filter.hpp
  geometry/time.hpp
  navigation/estimate.hpp
  navigation/hover_pilot.hpp
  navigation/navigator.hpp
  navigation/navigator_config.hpp
  navigation/paper_config.hpp
  navigation/reference_config.hpp
  navigation/sensor_readings.hpp
  navigation/weighted_flow.hpp
  stabilization/estimate_choice_config.hpp
  stabilization/hold_config.hpp
  stabilization/hold_controller.hpp
  stabilization/hold_decision.hpp
  stabilization/hold_plan.hpp
  stabilization/pid.hpp
  stabilization/tether.hpp
  stabilization/tether_model.hpp
  stabilization/vehicle_limits.hpp
  stabilization/velocity_model.hpp)
install(FILES ${PROJECT_SOURCE_DIR}/stillkite/stillkite.hpp
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stillkite COMPONENT development)
foreach(header IN LISTS STILLKITE_INCLUDED_HEADERS)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header}
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stillkite/${folder} COMPONENT development)
endforeach()

add_library(stillkite_all INTERFACE)
add_library(stillkite::stillkite ALIAS stillkite_all)
set_target_properties(stillkite_all PROPERTIES EXPORT_NAME stillkite)
target_link_libraries(stillkite_all INTERFACE stillkite_navigation)
install(TARGETS stillkite_all stillkite_navigation stillkite_stabilization stillkite_estimation
                stillkite_flow stillkite_geometry
        EXPORT stillkite COMPONENT development)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/stillkite)
install(EXPORT stillkite NAMESPACE stillkite:: FILE stillkite-targets.cmake
        DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/stillkite-config.cmake.in
                              ${PROJECT_BINARY_DIR}/stillkite-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stillkite-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stillkite-config.cmake
              ${PROJECT_BINARY_DIR}/stillkite-config-version.cmake
        DESTINATION ${package_dir} COMPONENT development)
