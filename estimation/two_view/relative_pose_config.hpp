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
  int max_iterations = 2000;
  int min_pairs = 12;
  bool refine = true;
  bool use_prior = true;
  bool model_test = true;
  double model_floor_px = 0.1;
  double vertical_sigma_deg = 0.5;
  int seed = 1;

  static void fields(auto& self, auto&& field) {
    field("threshold_px", self.threshold_px, kPositive,
          "Sampson error at which a pair counts as an outlier");
    field("confidence", self.confidence, Range{0.5, 0.999999},
          "probability of having drawn five inliers once, at which drawing ends");
    field("max_iterations", self.max_iterations, Range{1, 1e6}, "draws of five pairs, at most");
    field("min_pairs", self.min_pairs, Range{6, 1e6},
          "inliers without which the answer is `undecided`");
    field("refine", self.refine, "least squares on all inliers after the draws");
    field("use_prior", self.use_prior, "try the last frame's answer before any draw");
    field("model_test", self.model_test,
          "tell stillness, pure rotation and planes, where the essential matrix is degenerate");
    field("model_floor_px", self.model_floor_px, kNotNegative,
          "systematic error of the points, which is not to be taken for motion or depth");
    field("vertical_sigma_deg", self.vertical_sigma_deg, kPositive,
          "error of the known vertical, by which the two poses of a plane are told apart");
    field("seed", self.seed, Range{0, 2147483647}, "of the draws");
  }
};

/// What is known beforehand; each may be left out.
struct RelativePoseHints {
  std::optional<RelativePose> prior;               ///< the last frame's answer, or a prediction
  std::optional<Eigen::Vector3d> up_in_reference;  ///< any length
  std::optional<Eigen::Vector3d> up_in_current;    ///< any length
};

}  // namespace stillkite
