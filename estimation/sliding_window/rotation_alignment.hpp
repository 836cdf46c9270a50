#pragma once

#include "estimation/sliding_window/inertial_priors.hpp"
#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Gyroscope bias and clock offset by which the gyroscope's rotations between the frames agree with
/// the images (`epipolar_equations`). Sets the biases and the offset; the IMU readings of all
/// frames are integrated accordingly. False if the images do not determine the rotations.
[[nodiscard]] bool align_rotations(Window& window, const InertialPriors& priors);

}  // namespace stillkite
