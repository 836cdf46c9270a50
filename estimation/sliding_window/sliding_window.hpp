#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/sliding_window/initialization.hpp"
#include "estimation/sliding_window/window.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Feature in an image: number of its track, bearing on z = 1 with covariance.
struct FeatureObservation {
  std::int64_t track_id = 0;
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// Zero velocity by images.
struct CameraRest {
  Timestamp since;
  double velocity_sigma_m_s = 0;  ///< per axis
};

/// Visual-inertial fixed-lag smoother over keyframes and the latest frames; docs/fusion.md,
/// "Sliding window". Until initialized the state is the IMU's integral from the given pose.
class SlidingWindow {
 public:
  using Matrix15d = Eigen::Matrix<double, InertialIndex::kSize, InertialIndex::kSize>;

  /// `world_from_imu`: pose at the first frame; gravity corrects roll and pitch.
  SlidingWindow(const CameraExtrinsics& extrinsics, const RigidTransform& world_from_imu,
                const ImuNoise& noise, const InertialPriors& priors);

  /// Adds an image with the IMU samples since the previous one and the features of known tracks;
  /// estimates all states. The first frame has no samples. `rest`: the images show a camera at
  /// rest.
  void add_frame(Timestamp stamp, std::span<const ImuSample> samples,
                 std::span<const FeatureObservation> features,
                 const std::optional<CameraRest>& rest = {});

  /// Forgets everything but the pose, extrinsics and their priors; a new initialization follows.
  void restart();

  /// Makes the newest frame a keyframe, in which new tracks begin. Their numbers ascend and are
  /// greater than those of all known tracks.
  void take_keyframe(std::span<const FeatureObservation> features);

  [[nodiscard]] bool is_initialized() const { return is_initialized_; }
  [[nodiscard]] bool is_restarted() const { return is_restarted_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  /// Depth of the points in their first keyframes; empty without points.
  [[nodiscard]] std::optional<double> median_depth_m() const;
  /// State of the newest frame.
  [[nodiscard]] const InertialState& state() const { return window_.frames.back().state; }
  [[nodiscard]] const CameraExtrinsics& extrinsics() const { return window_.extrinsics; }
  /// Covariance of the newest frame's state, order of InertialIndex. Zero before the
  /// initialization.
  [[nodiscard]] const Matrix15d& covariance() const { return covariance_; }
  /// Pose at the first frame; roll and pitch by the vertical of the first initialization.
  [[nodiscard]] const RigidTransform& world_from_first() const { return world_from_first_; }
  /// Points that were measured in the newest frame, and those of them that fit the estimate.
  [[nodiscard]] int measured_points() const { return measured_points_; }
  [[nodiscard]] int inlier_points() const { return inlier_points_; }
  [[nodiscard]] const Window& window() const { return window_; }
  [[nodiscard]] const Initialization& last_initialization() const { return initialization_; }

 private:
  void begin_with(WindowFrame first);
  void align_first_pose(const Eigen::Quaterniond& before, const Eigen::Quaterniond& after);
  void predict(Timestamp stamp, std::span<const ImuSample> samples);
  void thin_chain();
  [[nodiscard]] bool thin_batch();
  void remove_oldest();
  void restart_tracks();
  void add_observations(std::span<const FeatureObservation> features);
  void try_initialization();
  void estimate_batch(bool is_full);
  void stay_at_rest(Timestamp stamp, std::span<const ImuSample> samples,
                    std::span<const FeatureObservation> features, const CameraRest& rest);
  void triangulate_tracks();
  void estimate();
  void update_covariance();
  void reject_outliers();
  void slide();
  void limit_keyframes();
  void remove_empty_tracks();

  ImuNoise noise_;
  InertialPriors priors_;
  Window window_;
  Initialization initialization_;
  RigidTransform world_from_first_;
  RestReadings rest_;
  bool is_initialized_ = false;
  bool is_batch_ = false;    // nothing is marginalized yet
  bool is_at_rest_ = false;  // since the first frame
  bool is_restarted_ = false;
  std::int64_t next_frame_id_ = 0;
  Matrix15d covariance_ = Matrix15d::Zero();
  int measured_points_ = 0;
  int inlier_points_ = 0;
};

}  // namespace stillkite
