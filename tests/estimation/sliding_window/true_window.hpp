#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>
#include <utility>

#include "estimation/sliding_window/initialization.hpp"
#include "hand_held_motion.hpp"

namespace stillkite {

inline constexpr ImuNoise kWindowImu{
    .gyro_density = 2e-4, .accel_density = 2e-3, .gyro_bias_walk = 2e-5, .accel_bias_walk = 1e-4};

/// Window at the truth: four frames, the first two are keyframes with points.
inline Window true_window() {
  const HandHeldMotion motion;
  std::mt19937 random(5);
  Window window;
  window.calibrated = window.extrinsics = window.first_extrinsics = motion.extrinsics;
  const auto points = points_in_view(motion, 40, random);
  constexpr double kInterval_s = 0.2;
  for (int i = 0; i < 4; ++i) {
    const double t_s = kInterval_s * i;
    WindowFrame frame;
    frame.id = i;
    frame.stamp = from_seconds(t_s);
    frame.state = motion.state(t_s);
    frame.gyro_rad_s = motion.angular_rate(t_s) + motion.gyro_bias_rad_s;
    frame.is_keyframe = i < 2;
    frame.imu = ImuPreintegration(kWindowImu);
    frame.imu.reintegrate(motion.gyro_bias_rad_s, motion.accel_bias_m_s2);
    if (i > 0) {
      for (const ImuSample& sample : motion.samples(t_s - kInterval_s, t_s, kWindowImu, random)) {
        frame.imu.add(sample);
      }
    }
    append_frame(window, std::move(frame));
    for (const FeatureObservation& feature : observe(motion, t_s, points, 1e-3, random)) {
      const Eigen::Matrix2d information =
          feature.covariance.llt().solve(Eigen::Matrix2d::Identity());
      const auto known = std::find_if(window.tracks.begin(), window.tracks.end(),
                                      [&](const auto& t) { return t.id == feature.track_id; });
      const bool is_of_second = feature.track_id % 2 == 1;
      if (known != window.tracks.end()) {
        known->observations.push_back({i, feature.bearing, information});
      } else if (i == (is_of_second ? 1 : 0)) {
        const RigidTransform world_from_camera =
            motion.state(t_s).world_from_imu * motion.extrinsics.imu_from_camera;
        const Eigen::Vector3d x =
            world_from_camera.inverse() * points[static_cast<std::size_t>(feature.track_id)];
        window.tracks.push_back({feature.track_id,
                                 {{i, feature.bearing, information}},
                                 InverseDepthPoint{x.hnormalized(), 1 / x.z()}});
      }
    }
  }
  std::sort(window.tracks.begin(), window.tracks.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  set_initial_prior(window, InertialPriors{});
  return window;
}

}  // namespace stillkite
