#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimation/fusion/fusion_config.hpp"
#include "estimation/fusion/fusion_state.hpp"

namespace stillkite {

/// Where a feature is seen, on z = 1.
struct FeatureView {
  int feature = 0;  ///< its number in the reference
  Eigen::Vector2d bearing;
  Eigen::Matrix2d covariance;
};

/// Where a landmark is seen, on z = 1.
struct LandmarkView {
  std::size_t landmark = 0;  ///< among all that there are
  Eigen::Vector2d bearing;
  Eigen::Matrix2d covariance;
  Eigen::Matrix2d usual_covariance;  ///< were it no stray
};

/// By which the variances of what a window is off by have grown: the further the camera is from
/// where it was taken (in depths), the less it looks the same.
[[nodiscard]] double window_growth(const FusionConfig& config, const Eigen::Vector3d& way);

/// By which the variance of a stray's view has: it is off by more, and alike in frame after frame.
[[nodiscard]] double stray_growth(const FusionConfig& config, const RunningRatio& stray);

/// The mean, by their median, of what a frame's views are off by: squared, over their covariance
/// and per degree of freedom. 0 of none.
[[nodiscard]] double usual_error(std::vector<double> squared);

/// What views are off by, squared, over their usual covariance and per degree of freedom.
struct ViewErrors {
  std::vector<double> squared;  ///< infinite where the landmark cannot be seen
  double usual = 0;
};

[[nodiscard]] ViewErrors view_errors(const FusionState& state,
                                     const std::vector<Landmark>& landmarks,
                                     const std::vector<LandmarkView>& views);

}  // namespace stillkite
