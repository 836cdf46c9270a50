#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {

/// What a fusion test's camera does: a hover about its start with a known motion.
struct FusionScene {
  double seconds = 10;
  double sway_m = 0.3;
  double turn_rad = 0.1;
  double pixel_sigma_px = 0.3;         ///< as the filter is told
  double true_noise_ratio = 1;         ///< of the pixels' noise to that
  double window_error_ratio = 0;       ///< of what windows are off by to the noise, both growing
  double window_error_way = 0.1;       ///< as FusionConfig's
  bool first_moves_backwards = false;  ///< landmark 0 shifts as if it were behind the camera
  int offered = 0;                     ///< so many points more, which may become landmarks
  int strays = 0;                      ///< so many landmarks are no points
  double stray_px = 0;  ///< each is off to its own side by that, a tenth of its depth away
  double focal_px = 480;
  double velocity_sigma_m_s = 1e-3;   ///< at the start, as the filter is told; it is at rest
  double lean_sigma_rad = 0;          ///< of its roll and pitch at the start, as the filter is told
  double log_unit_sigma = 0;          ///< as the filter is told
  double inverse_depth_spread = 0.5;  ///< 1 sigma, of the landmarks' over their guess
  double scale_error_log = 0;         ///< the landmarks' guesses are off by that, all alike
  bool has_imu = true;
  bool has_flow = false;
  bool has_landmarks = true;
  double drift_m_s2 = 0;         ///< along the world's y, beside the sway
  double renew_every_s = 0;      ///< a new anchor, with the landmarks that are in view; 0: never
  int renewed = 0;               ///< of them other points then, guessed anew
  double renewed_error_log = 0;  ///< those guesses are off by that, all alike
};

/// Of whose speed at the start nothing is known.
[[nodiscard]] inline FusionScene hover_of_unknown_speed() {
  FusionScene scene;
  scene.sway_m = 0.1;
  scene.turn_rad = 0.01;
  scene.pixel_sigma_px = 0.2;
  scene.velocity_sigma_m_s = 6;
  return scene;
}

/// The filter's defaults for views that err anew each time.
[[nodiscard]] inline FusionConfig white_noise() {
  FusionConfig config;
  config.window_error_way = 1e6;
  config.landmarks = 48;  // of twice as many no wrong start is sure of itself
  return config;
}

/// The same with ten landmarks, which is quicker.
[[nodiscard]] inline FusionConfig few_landmarks() {
  FusionConfig config = white_noise();
  config.landmarks = 10;
  return config;
}

/// As of windows that know the motion for that normal to sigma, and nothing of another normal.
[[nodiscard]] inline KeyframeView view_of(const PlaneMotion& motion, double sigma) {
  KeyframeView view{.motion = motion, .tilt_axes = TiltAxes::Identity(), .likelihood = {}};
  view.likelihood.covariance = sigma * sigma * Matrix6d::Identity();
  return view;
}

/// Exact pose and its derivatives at a time.
struct FusionTruth {
  RigidTransform world_from_camera;
  Eigen::Vector3d velocity_in_world_m_s;
  Eigen::Vector3d acceleration_in_world_m_s2;
};

/// A level camera that looks along the world's x, 3 m up; it is at its start, at rest, at time 0.
class FusionSimulation {
 public:
  FusionSimulation(const FusionScene& scene, const FusionConfig& config, std::uint64_t seed);

  /// To the next frame, 1/30 s on.
  void step();

  /// No landmark is in view any more, or they are again.
  void cover(bool is_covered) { scene_.has_landmarks = !is_covered; }

  /// From now on the first landmarks are seen so far beside where they are, in turn to either side.
  void shift_first(double shift_px, std::size_t count = 1) {
    shift_px_ = shift_px;
    shifted_ = count;
  }

  /// From now on the gyroscope's bias is another one, on each axis by so much.
  void shift_gyro_bias(double by_rad_s) { gyro_bias_.array() += by_rad_s; }

  [[nodiscard]] const FusionFilter& filter() const { return filter_; }
  [[nodiscard]] FusionFilter& filter() { return filter_; }
  [[nodiscard]] FusionTruth truth() const { return truth_at(time_s_); }
  [[nodiscard]] double time_s() const { return time_s_; }
  /// (translation, rotation vector) of the true pose from the estimate, world axes.
  [[nodiscard]] Vector6d pose_error() const;
  /// The same from the estimate in its upright world.
  [[nodiscard]] Vector6d upright_pose_error() const;

 private:
  [[nodiscard]] FusionTruth truth_at(double t_s) const;
  [[nodiscard]] Vector6d error_of(const RigidTransform& estimate) const;
  void update_from_plane();
  [[nodiscard]] std::vector<FeatureView> landmark_views();
  Eigen::Vector2d window_error_px(std::size_t i);
  [[nodiscard]] Eigen::Vector2d stray_error_px(std::size_t i) const;
  [[nodiscard]] Eigen::Vector3d way_in_depths(std::size_t i) const;
  void renew_anchor();
  Eigen::Vector3d add_point(int feature, double error_log);
  Eigen::Vector3d offer_point(int feature);
  [[nodiscard]] FeatureView reference_of(int feature, const Eigen::Vector2d& bearing);
  [[nodiscard]] Eigen::Vector2d random_bearing();
  [[nodiscard]] double normal() { return normal_(engine_); }
  [[nodiscard]] Eigen::Vector3d normal3() { return {normal(), normal(), normal()}; }

  FusionScene scene_;
  FusionConfig config_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  double time_s_ = 0;
  double keyframe_s_ = 0;
  double anchor_s_ = 0;
  Eigen::Vector3d sway_phase_, turn_phase_;
  Eigen::Vector3d gyro_bias_, accel_bias_;
  double height_error_log_ = 0;
  struct Window {
    Eigen::Vector2d error_px = Eigen::Vector2d::Zero();
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // from the anchor, in depths
  };
  std::vector<Window> windows_;
  std::vector<Eigen::Vector3d> points_;
  Eigen::Vector2d first_bearing_;
  double shift_px_ = 0;
  std::size_t shifted_ = 0;
  FusionFilter filter_;
};

}  // namespace stillkite
