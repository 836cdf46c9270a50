#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

/// Smooth displacement field e(p) of the image by a lens that differs from its calibration: a point
/// that the calibrated model projects to p - e(p) appears at p. With u = (x + 1/2) pi / width and
/// v = (y + 1/2) pi / height,
///
///     e = sum of a_ij cos(i u) cos(j v),   1 <= i + j <= 3.
///
/// The constant term is absent: it would be an error of the principal point.
struct LensError {
  struct Term {
    int i = 0;
    int j = 0;
    Eigen::Vector2d amplitude_px;
  };
  int width_px = 1;
  int height_px = 1;
  std::vector<Term> terms{};  ///< empty: no error

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& pixel) const;
};

/// Field with random coefficients. `rms_px`: RMS of the displacement's length over the image.
[[nodiscard]] LensError random_lens_error(const Camera& camera, double rms_px, std::uint64_t seed);

/// Bearing (x, y) of a pixel through the lens with its error; nullopt as of `undistort`.
[[nodiscard]] std::optional<Eigen::Vector2d> bearing_of(const Camera& camera,
                                                        const LensError& error,
                                                        const Eigen::Vector2d& pixel);

}  // namespace stillkite
