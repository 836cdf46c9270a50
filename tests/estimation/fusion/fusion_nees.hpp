#pragma once

#include <array>

#include "tests/estimation/fusion/fusion_scene.hpp"

namespace stillkite {

/// e^T P^-1 e of the pose: 6 when honest.
[[nodiscard]] double nees_of(const FusionSimulation& flight);

/// Averaged over seeds, second by second; printed.
[[nodiscard]] std::array<double, 10> nees_by_second(const FusionScene& scene,
                                                    const FusionConfig& config, int seeds = 60);

[[nodiscard]] double most(const std::array<double, 10>& nees);

}  // namespace stillkite
