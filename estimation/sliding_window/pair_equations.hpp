#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Normal equations of a camera pair of a host and another image, or of host and ground: four
/// variables, the host's GroundView.
struct PairEquations {
  static constexpr int kShared = SharedIndex::kSize + InertialIndex::kPoseSize;

  std::size_t target = 0;  ///< frame of the other image; of the ground the host
  /// By the shared variables, then the host's pose.
  Eigen::Matrix<double, 6, kShared> by_shared = Eigen::Matrix<double, 6, kShared>::Zero();
  Matrix6d by_target = Matrix6d::Zero();
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

/// Without measurements. `pair`: at the linearization points.
[[nodiscard]] PairEquations pair_equations(const Window& window, std::size_t host,
                                           std::size_t target, const CameraPair& pair);

/// Host and ground, without measurements.
[[nodiscard]] PairEquations ground_pair_equations(const Window& window, std::size_t host);

}  // namespace stillkite
