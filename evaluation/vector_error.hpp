#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

namespace stillkite {

/// Error of an estimated vector quantity per axis, in its unit.
struct VectorError {
  int samples = 0;
  Eigen::Vector3d rmse;
  Eigen::Vector3d median_abs;
  /// Pearson correlation; empty if estimate or truth is constant.
  std::array<std::optional<double>, 3> correlation;
};

/// Spans of equal length, sample by sample, in the same frame; std::nullopt with fewer than two.
[[nodiscard]] std::optional<VectorError> vector_error(std::span<const Eigen::Vector3d> estimate,
                                                      std::span<const Eigen::Vector3d> truth);

}  // namespace stillkite
