#pragma once

#include <array>

#include "estimation/verdict.hpp"
#include "io/setup/setup_finding.hpp"
#include "navigation/navigator_config.hpp"

// Questions about scene and estimator. Bounds: docs/check.md.

namespace stillkite {

/// Frames after the first by verdict.
struct VerdictCounts {
  int frames = 0, measured = 0, not_flat = 0, textureless = 0;

  void add(Verdict verdict);
  [[nodiscard]] double measured_ratio() const {
    return frames == 0 ? 0 : static_cast<double>(measured) / frames;
  }
};

/// Flat ground or not, by the flow without other sensors.
[[nodiscard]] SetupFinding ground_finding(const VerdictCounts& flow);

/// The policy of the configuration against the scene. `has_imu`: usable with the images.
[[nodiscard]] SetupFinding policy_finding(const EstimatorConfig& configured,
                                          const VerdictCounts& flow, const VerdictCounts& reference,
                                          bool has_imu);

/// Standard deviations of the flow at the end of the images examined.
struct ExpectedAccuracy {
  double position_sigma = 0;  ///< 3-D
  double path_length = 0;
  double velocity_sigma = 0;  ///< median, 3-D
  bool is_metric = false;     ///< lengths in m, else in initial heights
  double duration_s = 0;
  double initial_height = 1;
};
/// Doubtful above 10 % of the path and above the initial height.
[[nodiscard]] SetupFinding accuracy_finding(const VerdictCounts& flow,
                                            const ExpectedAccuracy& accuracy);

}  // namespace stillkite
