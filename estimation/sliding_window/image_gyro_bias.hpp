#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Gyroscope bias with which the rotated bearings of all pairs of frames fulfil the epipolar
/// constraint (Kneip and Lynen, ICCV 2013; He et al., CVPR 2023). Also for pure rotation and
/// planes. Empty with fewer than three usable pairs.
[[nodiscard]] std::optional<Eigen::Vector3d> gyro_bias_from_images(const Window& window,
                                                                   double prior_sigma_rad_s);

}  // namespace stillkite
