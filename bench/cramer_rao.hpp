#pragma once

#include "geometry/rigid_transform.hpp"
#include "simulation/flight/bench_scene.hpp"

namespace stillkite::bench {

/// Cramer-Rao bound of the twist (velocity, angular rate) from one image pair:
///
///     (sum over pixels (J^T grad)(J^T grad)^T / (2 sigma^2))^-1,
///
/// J the motion field times the interval, grad that of the noise-free previous image, sigma the
/// noise of each frame in grey values.
[[nodiscard]] Matrix6d cramer_rao_bound(const BenchScene& scene, double noise_grey);

}  // namespace stillkite::bench
