#pragma once

#include <optional>
#include <random>
#include <vector>

#include "estimation/plane/keyframe_view.hpp"
#include "estimation/sliding_window/sliding_window.hpp"
#include "hand_held_motion.hpp"

namespace stillkite {

/// Runs the window over a motion by hand, a keyframe every fifth frame.
struct WindowRun {
  static constexpr ImuNoise kImu{
      .gyro_density = 2e-4, .accel_density = 2e-3, .gyro_bias_walk = 2e-5, .accel_bias_walk = 1e-4};
  static constexpr double kBearingSigma = 5e-4;
  static constexpr double kFrame_s = 0.05;

  /// Roll and pitch of the first frame are unknown.
  explicit WindowRun(unsigned seed);

  void step();
  void step_in_the_dark() { advance({}); }
  void advance(const std::vector<FeatureObservation>& features,
               const std::optional<KeyframeView>& ground = {});
  /// Of the points, in the next frame.
  [[nodiscard]] std::vector<FeatureObservation> features();

  /// By position and yaw of the window's first frame.
  [[nodiscard]] RigidTransform truth_from_world() const;
  [[nodiscard]] InertialState aligned_state(const RigidTransform& truth_from_world) const;
  [[nodiscard]] InertialState truth() const { return motion.state(kFrame_s * (frame - 1)); }

  HandHeldMotion motion;
  std::mt19937 random;
  std::vector<Eigen::Vector3d> points;
  std::optional<SlidingWindow> window;
  double time_offset_s = 0;
  double imu_s = 0;  ///< end of the readings
  int frame = 0;
};

}  // namespace stillkite
