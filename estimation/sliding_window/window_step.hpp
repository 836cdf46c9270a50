#pragma once

#include <Eigen/Core>

#include "estimation/sliding_window/window_equations.hpp"

namespace stillkite {

/// Displacement of the variables under a change of scale by 100 %, about the first frame.
[[nodiscard]] Eigen::VectorXd scale_direction(const Window& window);

/// Moves all variables by a solution of the equations, and the points accordingly. The similarity
/// that a step contains is applied as such.
void apply_step(const Eigen::VectorXd& step, const WindowLinearization& linear, Window& window);

}  // namespace stillkite
