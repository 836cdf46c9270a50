#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// OpenCV estimators of the essential matrix; the hold paper uses `ransac`.
enum class EssentialMethod { ransac, usac_default, usac_fast, usac_accurate, usac_magsac };
template <>
struct EnumNames<EssentialMethod> {
  static constexpr auto value = std::to_array<std::pair<EssentialMethod, std::string_view>>(
      {{EssentialMethod::ransac, "ransac"},
       {EssentialMethod::usac_default, "usac_default"},
       {EssentialMethod::usac_fast, "usac_fast"},
       {EssentialMethod::usac_accurate, "usac_accurate"},
       {EssentialMethod::usac_magsac, "usac_magsac"}});
};

struct OpenCvPoseConfig {
  EssentialMethod essential_method = EssentialMethod::ransac;
  double threshold_px = 1.0;
  double confidence = 0.999;
  bool correct_matches = true;

  static void fields(auto& self, auto&& field) {
    field("essential_method", self.essential_method, "OpenCV estimator of the essential matrix");
    field("threshold_px", self.threshold_px, kPositive, "maximum epipolar distance of an inlier");
    field("confidence", self.confidence, Range{0.5, 0.999999},
          "RANSAC confidence: probability of one sample of five inliers");
    field("correct_matches", self.correct_matches,
          "optimal triangulation correction of the inliers before the cheirality test");
  }
};

}  // namespace stillkite
