#include "estimation/landmark_view.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "estimation/landmark_model.hpp"

namespace stillkite {

ViewErrors view_errors(const FusionState& state, const std::vector<Landmark>& landmarks,
                       const std::vector<LandmarkView>& views) {
  constexpr double kMedian = 0.693;  // of chi-square with two degrees of freedom, for each
  constexpr double kLeast = 0.02;
  ViewErrors errors;
  errors.squared.reserve(views.size());
  for (const LandmarkView& view : views) {
    const auto left = landmark_innovation(state, landmarks[view.landmark], 0, view.bearing,
                                          view.usual_covariance);
    errors.squared.push_back(left ? left->residual.dot(left->noise.llt().solve(left->residual)) / 2
                                  : HUGE_VAL);
  }
  if (views.empty()) return errors;
  std::vector<double> sorted = errors.squared;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  errors.usual = std::max(*middle / kMedian, kLeast);
  return errors;
}

}  // namespace stillkite
