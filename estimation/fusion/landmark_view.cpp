#include "estimation/fusion/landmark_view.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "estimation/fusion/landmark_model.hpp"
#include "geometry/median.hpp"

namespace stillkite {

double window_growth(const FusionConfig& config, const Eigen::Vector3d& way) {
  return 1 + way.norm() / config.window_error_way;
}

double stray_growth(const FusionConfig& config, const RunningRatio& stray) {
  const double more = std::max(0.0, stray.value() - config.stray_above_ratio);
  return 1 + config.stray_correlated_frames * more;
}

double usual_error(std::vector<double> squared) {
  constexpr double kMedian = 0.693;  // of chi-square with two degrees of freedom, for each
  constexpr double kLeast = 0.02;
  if (squared.empty()) return 0;
  return std::max(upper_median(squared) / kMedian, kLeast);
}

ViewErrors view_errors(const FusionState& state, const std::vector<Landmark>& landmarks,
                       const std::vector<LandmarkView>& views) {
  ViewErrors errors;
  errors.squared.reserve(views.size());
  for (const LandmarkView& view : views) {
    const Landmark& landmark = landmarks[view.landmark];
    const auto expected = project_landmark(state.world_from_camera, state.world_from_anchor,
                                           landmark.bearing, landmark.inverse_depth);
    if (!expected) {
      errors.squared.push_back(HUGE_VAL);
      continue;
    }
    const Eigen::Vector2d off = view.bearing - expected->bearing;
    errors.squared.push_back(off.dot(view.usual_covariance.llt().solve(off)) / 2);
  }
  errors.usual = usual_error(errors.squared);
  return errors;
}

}  // namespace stillkite
