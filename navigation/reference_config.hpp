#pragma once

#include "estimation/two_view/opencv_relative_pose.hpp"
#include "estimation/two_view/relative_pose_config.hpp"
#include "estimation/two_view/rotation_gate.hpp"
#include "flow/feature_detection.hpp"
#include "flow/feature_tracker.hpp"
#include "flow/opencv_feature_tracker.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// How the reference's features are found again.
enum class Association { windows, opencv, matching };
template <>
struct EnumNames<Association> {
  static constexpr auto value = std::to_array<std::pair<Association, std::string_view>>(
      {{Association::windows, "windows"},
       {Association::opencv, "opencv"},
       {Association::matching, "matching"}});
};

/// Who finds the pose that explains the features.
enum class PoseSolver { own, opencv };
template <>
struct EnumNames<PoseSolver> {
  static constexpr auto value = std::to_array<std::pair<PoseSolver, std::string_view>>(
      {{PoseSolver::own, "own"}, {PoseSolver::opencv, "opencv"}});
};

/// Everything the reference estimator can be told.
struct ReferenceConfig {
  int renew_every_frames = 0;
  int min_features = 100;
  double renew_below_ratio = 0;
  int patience_frames = 10;
  int seek_home_every_frames = 10;
  DetectorConfig detector{.max_features = 1000, .quality = 0.003, .min_distance_px = 8};
  Association association = Association::windows;
  FeatureTrackerConfig windows;
  OpenCvFeatureTrackerConfig opencv;
  PoseSolver solver = PoseSolver::own;
  RelativePoseConfig pose;
  OpenCvPoseConfig opencv_pose;
  RotationGateConfig gate;

  static void fields(auto& self, auto&& field) {
    field("renew_every_frames", self.renew_every_frames, kNotNegative,
          "a new reference frame that often; 0: only when too few features are left");
    field("min_features", self.min_features, Range{8, 20000},
          "features still in view, below which the frame becomes the new reference");
    field("renew_below_ratio", self.renew_below_ratio, Range{0, 0.9},
          "the same as a share of the most that were found of it");
    field(
        "patience_frames", self.patience_frames, kNotNegative,
        "frames in a row with too few of them before a new reference is taken: they may come back");
    field("seek_home_every_frames", self.seek_home_every_frames, kNotNegative,
          "how often the first reference is looked for while another one is at hand; 0: never");
    field("detector", self.detector, "features of the reference frame");
    field("association", self.association,
          "the same features in later frames: by our Lucas-Kanade windows, by OpenCV's (the hold "
          "paper's way), or by matching descriptors (what it tried first)");
    field("windows", self.windows, "association by windows");
    field("opencv", self.opencv, "association by OpenCV's pyramidal Lucas-Kanade");
    field("solver", self.solver, "of the pose: ours, or OpenCV's (the hold paper's way)");
    field("pose", self.pose, "our solver");
    field("opencv_pose", self.opencv_pose, "OpenCV's solver");
    field("gate", self.gate, "rejection of rotations that change too fast");
  }
};

}  // namespace stillkite
