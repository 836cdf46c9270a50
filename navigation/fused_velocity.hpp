#pragma once

#include <Eigen/Geometry>

#include "estimation/covariance_intersection.hpp"
#include "estimation/fusion/fusion_filter.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Mean velocity, m/s, over the interval of `step_s` that ends at the filter's frame: the way by
/// both its ends, of which the later frame has told too; after a leap the filter's. In the axes
/// that `world_from_axes` has.
[[nodiscard]] VectorEstimate velocity_by_way(const FusionFilter& filter, double step_s,
                                             const Eigen::Quaterniond& world_from_axes);

/// Both that and the flow's own filter's, which takes the drone to fly smoothly and tells heights
/// over the ground per second: times the filter's height. They come of the same pixels;
/// `variance_ratio` >= 1 is what the flow's windows are told to err by. Where they are further
/// apart than `gate_sigma` the way's alone.
[[nodiscard]] VectorEstimate velocity_by_way_and_ground(const FusionFilter& filter,
                                                        const VectorEstimate& by_way,
                                                        const NavigationEstimate& flow,
                                                        double flow_height_m, double variance_ratio,
                                                        double gate_sigma);

}  // namespace stillkite
