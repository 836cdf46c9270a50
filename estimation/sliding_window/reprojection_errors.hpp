#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Camera pairs of a window, each computed once; at the present estimate or at the linearization
/// points.
class CameraPairs {
 public:
  CameraPairs(const Window& window, bool at_first_estimates)
      : window_(window),
        at_first_estimates_(at_first_estimates),
        pairs_(window.frames.size() * window.frames.size()) {}

  [[nodiscard]] const CameraPair& at(std::size_t host, std::size_t target);

 private:
  const Window& window_;
  bool at_first_estimates_;
  std::vector<std::optional<CameraPair>> pairs_;
};

/// Ground in the cameras of a window, each computed once.
class GroundViews {
 public:
  GroundViews(const Window& window, bool at_first_estimates)
      : window_(window), at_first_estimates_(at_first_estimates), views_(window.frames.size()) {}

  [[nodiscard]] const GroundView& at(std::size_t frame);

 private:
  const Window& window_;
  bool at_first_estimates_;
  std::vector<std::optional<GroundView>> views_;
};

/// Information on a point's inverse depth, m^2, in one observation for known poses; 0 behind the
/// camera.
[[nodiscard]] double inverse_depth_information(const CameraPair& pair,
                                               const InverseDepthPoint& point,
                                               const WindowObservation& observation);

/// Reprojection errors of single observations.
class ReprojectionErrors {
 public:
  explicit ReprojectionErrors(const Window& window) : window_(window), pairs_(window, false) {}

  /// On z = 1; empty behind the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> residual(const WindowTrack& track,
                                                        const WindowObservation& observation);
  /// Squared, over its variance; infinite behind the camera.
  [[nodiscard]] double squared(const WindowTrack& track, const WindowObservation& observation);

 private:
  const Window& window_;
  CameraPairs pairs_;
};

}  // namespace stillkite
