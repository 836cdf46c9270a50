#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/fusion/fusion_state.hpp"

namespace stillkite {

/// Of what the anchor sees at `bearing`: the ground, `height` (map units) below, where the line of
/// sight meets it within some heights, else as far as that. Inverse depth, 1 / map units.
[[nodiscard]] double guessed_inverse_depth(const FusionState& state, const Eigen::Vector2d& bearing,
                                           double height);

/// By the lines of sight m of the anchor and b of the camera, b x (R_ca m + rho t) = 0. Nothing
/// where they would have turned too little against each other, were it as near as is guessed, to
/// tell how near it is.
[[nodiscard]] std::optional<double> triangulated_inverse_depth(const FusionState& state,
                                                               const Eigen::Vector2d& in_anchor,
                                                               const Eigen::Vector2d& in_camera,
                                                               double guess);

}  // namespace stillkite
