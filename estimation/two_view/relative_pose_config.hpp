#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "estimation/two_view/relative_pose.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

struct RelativePoseConfig {
  double threshold_px = 1.0;
  double confidence = 0.999;
  bool model_test = true;
  double model_floor_px = 0.1;
  double vertical_sigma_deg = 0.5;
  int seed = 1;

  static void fields(auto& self, auto&& field) {
    field("threshold_px", self.threshold_px, kPositive, "maximum Sampson error of an inlier");
    field("confidence", self.confidence, Range{0.5, 0.999999},
          "RANSAC confidence: probability of one sample of five inliers");
    field("model_test", self.model_test,
          "model selection: no motion, pure rotation, plane or essential matrix");
    field("model_floor_px", self.model_floor_px, kNonNegative,
          "systematic error of the points, excluded from motion and depth evidence");
    field("vertical_sigma_deg", self.vertical_sigma_deg, kPositive,
          "standard deviation of the given vertical, which resolves the two poses of a plane");
    field("seed", self.seed, Range{0, 2147483647}, "seed of the random sampling");
  }
};

/// Optional prior information.
struct RelativePoseHints {
  std::optional<RelativePose> prior;               ///< pose of the last frame, or a prediction
  std::optional<Eigen::Vector3d> up_in_reference;  ///< any length
  std::optional<Eigen::Vector3d> up_in_current;    ///< any length
};

}  // namespace stillkite
