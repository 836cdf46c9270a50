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
#include "navigation/row_times.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// The reference estimator of the hold paper (section III): every frame is compared with a
/// remembered one. It tells rotation and the direction of the way from there, no length, no speed.
class ReferenceNavigator {
 public:
  /// Whether these features of the first frame and those that its pose explains may be seen now.
  using HomeCheck = std::function<bool(const FeatureBearings& bearings,
                                       const std::vector<unsigned char>& inliers)>;

  ReferenceNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                     const NavigatorConfig& config, const InitialState& initial, Mode mode);

  /// The first frame is found again where `is_consistent_relocalization`, if there is one, does not
  /// contradict.
  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings,
                          const HomeCheck& is_consistent_relocalization = {});

  /// The features of the last frame and its pose; empty where none was looked for.
  [[nodiscard]] const FeatureBearings& bearings() const { return bearings_; }
  /// One a pair of the bearings, 1 where the pose explains it.
  [[nodiscard]] const std::vector<unsigned char>& inliers() const { return inliers_; }
  /// What the last frame's features are off by, squared, over what their covariances say; nothing
  /// where its pose is not to be trusted.
  [[nodiscard]] std::optional<double> unit_variance() const { return unit_variance_; }

  /// The features of the last frame that were found, of weight 0 where its pose does not explain
  /// them.
  [[nodiscard]] const std::vector<WindowFlow>& windows() const { return windows_; }

 private:
  /// A camera's attitude; covariances of rotation vectors, the first in the world.
  struct Attitude {
    Timestamp stamp;
    Eigen::Quaterniond world_from_camera;
    Eigen::Matrix3d covariance;
    Eigen::Matrix3d covariance_from_reference = Eigen::Matrix3d::Zero();  ///< in the camera
  };

  /// A remembered frame.
  struct Reference {
    FeatureAssociation association;
    Attitude attitude;
    RowTimes row_times;
    int most_found = 0;  // of its features, in one frame
  };

  NavigationEstimate start(const Frame& frame);
  [[nodiscard]] RelativePoseEstimate estimate(
      const std::vector<BearingPair>& pairs, const Reference& reference,
      const std::optional<RelativePose>& prior,
      const std::optional<Eigen::Quaterniond>& world_from_body) const;
  [[nodiscard]] bool look_for_home(const Frame& frame, const SensorReadings& readings,
                                   const HomeCheck& is_consistent_relocalization);
  void go_home(Timestamp now);
  [[nodiscard]] Reference fresh_reference() const;
  void begin_report(Timestamp now);
  [[nodiscard]] MotionEstimate carried_on(Timestamp now) const;
  void begin_reference();
  [[nodiscard]] Verdict judge(const RelativePoseEstimate& pose, int features);
  [[nodiscard]] bool is_swept_away(int features) const;
  void report(const FeatureTracks& tracks, const RelativePoseEstimate& pose, Verdict verdict);
  [[nodiscard]] int fewest_features(const Reference& reference) const;
  void turn(const RelativePoseEstimate& pose, Timestamp now);
  void renew_reference(const Frame& frame, int features, Verdict verdict);
  [[nodiscard]] bool take_reference(const Frame& frame, bool measured);
  [[nodiscard]] bool set_reference(const Frame& frame);
  [[nodiscard]] bool keeps_home() const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  ReferenceConfig config_;
  RigidTransform start_;  // world from camera
  Mode mode_;
  double readout_s_;
  RotationGate gate_;

  std::vector<Reference> references_;  // the first one and, where that is out of view, another
  Attitude current_;
  Timestamp start_stamp_;
  std::optional<RelativePose> last_pose_;  // from the reference at hand
  std::optional<Twist> twist_;
  Eigen::Matrix3d rate_covariance_ = Eigen::Matrix3d::Zero();
  bool has_reference_ = false;
  bool on_first_reference_ = true;
  bool is_rate_known_ = true;  // the last attitude is by the reference at hand
  int frames_since_reference_ = 0;
  int frames_away_ = 0;      // from home
  int failures_ = 0;         // frames in a row that found too few features
  int features_before_ = 0;  // found in the last frame that was not lost
  ReferenceReport report_;
  FeatureBearings bearings_;
  std::vector<unsigned char> inliers_;
  std::optional<double> unit_variance_;
  std::vector<cv::Point2f> followed_px_;  // inliers, in the image at hand
  std::vector<WindowFlow> windows_;
};

}  // namespace stillkite
