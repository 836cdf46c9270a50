#pragma once

#include "estimation/two_view/opencv_pose_config.hpp"
#include "estimation/two_view/relative_pose_config.hpp"
#include "estimation/two_view/rotation_gate_config.hpp"
#include "flow/detector_config.hpp"
#include "flow/feature_tracker_config.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Association of the reference's features with later frames.
enum class Association { windows, opencv, matching };
template <>
struct EnumNames<Association> {
  static constexpr auto value = std::to_array<std::pair<Association, std::string_view>>(
      {{Association::windows, "windows"},
       {Association::opencv, "opencv"},
       {Association::matching, "matching"}});
};

/// Relative pose solver.
enum class PoseSolver { own, opencv };
template <>
struct EnumNames<PoseSolver> {
  static constexpr auto value = std::to_array<std::pair<PoseSolver, std::string_view>>(
      {{PoseSolver::own, "own"}, {PoseSolver::opencv, "opencv"}});
};

/// Configuration of the reference estimator: relative pose to a reference image.
struct ReferenceConfig {
  int renew_every_frames = 0;
  int min_features = 100;
  double renew_below_ratio = 0;
  int patience_frames = 10;
  int relocalize_every_frames = 10;
  DetectorConfig detector{.max_features = 1000, .quality = 0.003, .min_distance_px = 8};
  Association association = Association::windows;
  FeatureTrackerConfig windows;
  OpenCvFeatureTrackerConfig opencv;
  PoseSolver solver = PoseSolver::own;
  RelativePoseConfig pose;
  OpenCvPoseConfig opencv_pose;
  RotationGateConfig gate;

  static void fields(auto& self, auto&& field) {
    field("renew_every_frames", self.renew_every_frames, kNonNegative,
          "frames after which the reference is replaced; 0: only if too few features are left");
    field("min_features", self.min_features, Range{8, 20000},
          "minimum number of associated features; below it the frame becomes the reference");
    field("renew_below_ratio", self.renew_below_ratio, Range{0, 0.9},
          "minimum ratio of associated features to the maximum for this reference; policy fused: "
          "at least fusion.renew_below_ratio");
    field("patience_frames", self.patience_frames, kNonNegative,
          "consecutive unmeasured frames with too few features before the reference is replaced");
    field("relocalize_every_frames", self.relocalize_every_frames, kNonNegative,
          "frames between relocalizations on the first reference after it was left; 0: never");
    field("detector", self.detector, "feature detection in the reference frame");
    field("association", self.association,
          "feature association: Lucas-Kanade patches (windows), OpenCV's pyramidal Lucas-Kanade as "
          "in the hold paper (opencv), or descriptor matching, its first attempt (matching)");
    field("windows", self.windows, "association by Lucas-Kanade patches");
    field("opencv", self.opencv, "association by OpenCV's pyramidal Lucas-Kanade");
    field("solver", self.solver, "relative pose solver: own, or OpenCV's as in the hold paper");
    field("pose", self.pose, "own solver");
    field("opencv_pose", self.opencv_pose, "OpenCV's solver");
    field("gate", self.gate, "gate on the rotation between frames");
  }
};

}  // namespace stillkite
