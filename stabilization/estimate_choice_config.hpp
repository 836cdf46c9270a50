#pragma once

#include "geometry/fields.hpp"

namespace stillkite {

/// Thresholds of the consistency test between the two estimates of a frame.
struct EstimateChoiceConfig {
  double agreement_sigmas = 3;
  double rotation_sigma_deg = 1;
  double translation_sigma_ratio = 0.02;
  double max_relief_ratio = 0.2;
  int patience_frames = 10;

  static void fields(auto& self, auto&& field) {
    field("agreement_sigmas", self.agreement_sigmas, Range{0.1, 100},
          "maximum difference of flow and reference in standard deviations: chi-square test of the "
          "three components at the probability of a normal variable");
    field("rotation_sigma_deg", self.rotation_sigma_deg, Range{0.01, 45},
          "standard deviation of the rotation difference in addition to both covariances: "
          "calibration error and initial tilt error");
    field("translation_sigma_ratio", self.translation_sigma_ratio, Range{1e-4, 1},
          "standard deviation of the flow's translation across the reference's direction in "
          "addition to both covariances, in initial heights");
    field("max_relief_ratio", self.max_relief_ratio, Range{0, 1},
          "maximum share of the features' parallax that a flat ground leaves unexplained");
    field("patience_frames", self.patience_frames, Range{1, 1000},
          "consecutive frames that must favour the other estimator before a switch; a lost "
          "estimator is replaced at once");
  }
};

}  // namespace stillkite
