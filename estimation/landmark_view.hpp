#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimation/fusion_state.hpp"

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

/// What views are off by, squared, over their usual covariance and per degree of freedom.
struct ViewErrors {
  std::vector<double> squared;  ///< infinite where the landmark cannot be seen
  double usual = 0;             ///< the mean, by their median
};

[[nodiscard]] ViewErrors view_errors(const FusionState& state,
                                     const std::vector<Landmark>& landmarks,
                                     const std::vector<LandmarkView>& views);

}  // namespace stillkite
