#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/sliding_window/initialization.hpp"
#include "estimation/sliding_window/window.hpp"
#include "estimation/sliding_window/window_tracks.hpp"
#include "geometry/time.hpp"

namespace stillkite {

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

  /// `world_from_imu`: pose at the first frame; gravity corrects roll and pitch. `start`: if its
  /// height above the ground is known.
  SlidingWindow(const CameraExtrinsics& extrinsics, const RigidTransform& world_from_imu,
                const ImuNoise& noise, const InertialPriors& priors,
                const std::optional<StartAboveGround>& start = {});

  /// Adds an image with new IMU readings and the features of known tracks; estimates all states.
  /// Readings may be late, or ahead of the image. `rest`: the images show a camera at rest.
  /// `ground`: dense alignment to the ground's keyframe.
  void add_frame(Timestamp stamp, std::span<const ImuInterval> readings,
                 std::span<const FeatureObservation> features,
                 const std::optional<CameraRest>& rest = {},
                 const std::optional<KeyframeView>& ground = {});

  /// Forgets everything but the pose; a new initialization follows.
  void restart();

  /// As move_window().
  void move(const Eigen::Quaterniond& yaw, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Makes the newest frame a keyframe, in which new tracks begin. Their numbers ascend and are
  /// greater than those of all known tracks. `realigned`: features of the reference keyframe, by
  /// its image, instead of their observations in the newest frame, if any.
  void take_keyframe(std::span<const FeatureObservation> features,
                     std::span<const FeatureObservation> realigned = {});

  /// Makes the newest frame the keyframe to which the ground of the next ones is aligned.
  void take_ground_keyframe();

  [[nodiscard]] bool is_initialized() const { return is_initialized_; }
  [[nodiscard]] bool is_restarted() const { return is_restarted_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  /// State of the newest frame.
  [[nodiscard]] const InertialState& state() const { return window_.frames.back().state; }
  /// All measurements together, not the start's height alone, give the scale.
  [[nodiscard]] bool is_scale_measured() const { return is_initialized_ && !is_batch_; }
  /// The height above a ground plane is known to 0.5 %.
  [[nodiscard]] bool can_align_to_ground() const;
  /// Pose at the newest image.
  [[nodiscard]] RigidTransform world_from_imu() const {
    return window_.frames.back().world_from_imu_after(window_.image_shift_s(), false);
  }
  /// IMU samples between two images.
  [[nodiscard]] std::vector<ImuSample> samples_between(Timestamp from, Timestamp to) const {
    return window_.imu.between(window_.imu_time(from), window_.imu_time(to));
  }
  [[nodiscard]] const CameraExtrinsics& extrinsics() const { return window_.extrinsics; }
  /// Covariance of rotation and lever arm of the camera, order of ExtrinsicsIndex: of the prior
  /// before the initialization.
  [[nodiscard]] Matrix6d mount_covariance() const;
  /// Covariance of the newest frame's state, order of InertialIndex. Zero before the
  /// initialization.
  [[nodiscard]] const Matrix15d& covariance() const { return covariance_; }
  /// Pose at the first frame; roll and pitch by the vertical of the first initialization.
  [[nodiscard]] const RigidTransform& world_from_first() const { return world_from_first_; }
  /// Points that were measured in the newest frame, and those of them that fit the estimate.
  [[nodiscard]] const MeasuredPoints& points() const { return points_; }
  [[nodiscard]] const Window& window() const { return window_; }
  [[nodiscard]] const Initialization& last_initialization() const { return initialization_; }
  [[nodiscard]] const InertialPriors& priors() const { return priors_; }
  /// Contradictory attempts in a row.
  [[nodiscard]] int contradictions() const { return contradictions_; }

 private:
  static constexpr double kSettledScale_ratio = 0.005;  // for first-estimate Jacobians

  void begin_with(WindowFrame first);
  void align_first_pose(const Eigen::Quaterniond& before, const Eigen::Quaterniond& after);
  void add_readings(std::span<const ImuInterval> readings);
  void forget_readings();
  void add_points();
  void align_to_ground(const KeyframeView& ground);
  void reject_alignment();
  void predict(Timestamp stamp);
  void thin_chain();
  [[nodiscard]] bool thin_batch();
  void remove_oldest();
  void try_initialization();
  [[nodiscard]] bool try_above_ground();
  void estimate_batch(bool is_full);
  [[nodiscard]] bool is_settled() const;
  void forget_start();
  void forget_ground();
  void forget_estimate();
  void stay_at_rest(Timestamp stamp, std::span<const ImuInterval> readings,
                    std::span<const FeatureObservation> features, const CameraRest& rest);
  void estimate();
  void update_covariance();
  void slide();
  void limit_keyframes();

  ImuNoise noise_;
  InertialPriors priors_;
  Window window_;
  Initialization initialization_;
  int contradictions_ = 0;
  RigidTransform world_from_first_;
  std::optional<InitialRest> rest_;  // of the batch's first frame
  bool is_initialized_ = false;
  bool is_batch_ = false;  // nothing is marginalized yet
  bool is_at_rest_ = false;
  bool is_restarted_ = false;
  std::int64_t next_frame_id_ = 0;
  Matrix15d covariance_ = Matrix15d::Zero();
  MeasuredPoints points_;
};

}  // namespace stillkite
