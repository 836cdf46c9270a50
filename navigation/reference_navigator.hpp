#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"
#include "estimation/two_view/rotation_gate.hpp"
#include "geometry/camera.hpp"
#include "navigation/feature_association.hpp"
#include "navigation/feature_bearings.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/rolling_shutter_correction.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Reference estimator of the hold paper, section III: relative pose of every frame to a reference
/// frame. Measures rotation and translation direction; no length, no velocity.
class ReferenceNavigator {
 public:
  /// Accepts or rejects a relocalization by the first reference's features and their inliers.
  using RelocalizationCheck = std::function<bool(const FeatureBearings& bearings,
                                                 const std::vector<unsigned char>& inliers)>;

  ReferenceNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                     const NavigatorConfig& config, const InitialState& initial, Mode mode);

  /// `is_consistent_relocalization`: additional condition for a relocalization; empty: none.
  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings,
                          const RelocalizationCheck& is_consistent_relocalization = {});

  /// Bearings of the features associated in the last frame; empty if none were.
  [[nodiscard]] const FeatureBearings& bearings() const { return bearings_; }
  /// One per pair of `bearings()`: 1 inlier, 0 outlier of the estimated pose.
  [[nodiscard]] const std::vector<unsigned char>& inliers() const { return inliers_; }
  /// Variance of unit weight of the last frame; empty unless its verdict is ok.
  [[nodiscard]] std::optional<double> unit_variance() const { return unit_variance_; }

  /// Feature displacements since the reference; weight 0 marks an outlier.
  [[nodiscard]] const std::vector<WeightedFlow>& flow_vectors() const { return flow_vectors_; }

 private:
  /// Attitude of a camera; covariances of rotation vectors.
  struct Attitude {
    Timestamp stamp;
    Eigen::Quaterniond world_from_camera;
    Eigen::Matrix3d covariance;                                           ///< in world
    Eigen::Matrix3d covariance_from_reference = Eigen::Matrix3d::Zero();  ///< in camera
    Eigen::Matrix3d independent_covariance = Eigen::Matrix3d::Zero();  ///< without the lens error
    Eigen::Vector2d mean_displacement_px = Eigen::Vector2d::Zero();    ///< from the reference
  };

  struct Reference {
    FeatureAssociation association;
    Attitude attitude;
    RollingShutterCorrection rolling_shutter_correction;
    int max_found = 0;  // associated features in one frame
  };

  NavigationEstimate initialize(const Frame& frame);
  NavigationEstimate stand_still(const Frame& frame, const FrameInterval& interval);
  [[nodiscard]] RelativePoseEstimate estimate(
      const std::vector<BearingPair>& pairs, const Reference& reference,
      const std::optional<RelativePose>& prior,
      const std::optional<Eigen::Quaterniond>& world_from_body) const;
  [[nodiscard]] bool try_relocalization(const Frame& frame, const SensorReadings& readings,
                                        const RelocalizationCheck& is_consistent_relocalization);
  void relocalize(Timestamp now);
  [[nodiscard]] Reference make_reference() const;
  void begin_report(Timestamp now);
  [[nodiscard]] MotionEstimate predicted_motion(Timestamp now) const;
  void begin_reference();
  [[nodiscard]] Verdict classify(const RelativePoseEstimate& pose, int features);
  [[nodiscard]] bool is_sudden_loss(int features) const;
  void report(const FeatureTracks& tracks, const RelativePoseEstimate& pose, Verdict verdict);
  [[nodiscard]] int min_features(const Reference& reference) const;
  [[nodiscard]] double lens_variance_ratio(const RelativePoseEstimate& pose,
                                           double displacement_px) const;
  void update_attitude(const RelativePoseEstimate& pose, const Eigen::Matrix3d& independent,
                       const Frame& frame);
  void renew_reference(const Frame& frame, int features, Verdict verdict);
  [[nodiscard]] bool take_reference(const Frame& frame, bool measured);
  [[nodiscard]] bool set_reference(const Frame& frame);
  [[nodiscard]] bool keeps_first_reference() const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  ReferenceConfig config_;
  RigidTransform world_from_initial_;  // camera at the first frame
  Mode mode_;
  double readout_s_;
  double lens_sigma_px_;
  RotationGate gate_;

  std::vector<Reference> references_;  // the first and, while that is out of view, the current one
  Attitude current_;
  Timestamp initial_stamp_;
  std::optional<RelativePose> last_pose_;  // from the current reference
  std::optional<Twist> twist_;
  Eigen::Matrix3d rate_covariance_ = Eigen::Matrix3d::Zero();
  bool has_reference_ = false;
  bool on_first_reference_ = true;
  bool has_previous_attitude_ = true;  // the last attitude is relative to the current reference
  int frames_since_reference_ = 0;
  int frames_off_first_reference_ = 0;
  int failures_ = 0;           // consecutive frames with too few features
  int previous_features_ = 0;  // associated in the last frame that was not lost
  ReferenceReport report_;
  FeatureBearings bearings_;
  std::vector<unsigned char> inliers_;
  std::optional<double> unit_variance_;
  std::vector<cv::Point2f> tracked_px_;  // inliers in the current image
  std::vector<WeightedFlow> flow_vectors_;
};

}  // namespace stillkite
