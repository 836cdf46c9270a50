#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

namespace stillkite {

/// Error of an estimated vector quantity, per axis, in its own unit.
struct VectorError {
  int samples = 0;
  Eigen::Vector3d rmse;
  Eigen::Vector3d median_abs;
  /// Pearson's; nothing where estimate or truth does not vary.
  std::array<std::optional<double>, 3> correlation;
};

/// Both spans hold the same moments, in the same frame; nothing of no samples.
[[nodiscard]] std::optional<VectorError> vector_error(std::span<const Eigen::Vector3d> estimate,
                                                      std::span<const Eigen::Vector3d> truth);

}  // namespace stillkite
