#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/plane/plane_solver.hpp"

namespace stillkite {

/// Relief of the ground in one alignment: residual flow of the tiles along their epipolar lines in
/// excess of that across them, over the flow of the translation.
struct ReliefMeasurement {
  double variance = 0;     ///< of relief over height, without the fitted plane; noise: negative
  double sigma = 0;        ///< standard deviation of `variance` with isotropic noise
  double across = 0;       ///< variance across the epipolar lines, like `variance`: noise
  double parallax_px = 0;  ///< median flow of the translation, on the level of the measurement
};

/// True if relief of this ratio displaces the tiles within the range of Lucas-Kanade.
[[nodiscard]] bool is_in_range(const ReliefMeasurement& measurement, double relief_ratio);

/// Measures the relief about the plane that fits best, by medians over the textured tiles.
/// `translation`: of the aligned motion. Empty without enough tiles with parallax.
[[nodiscard]] std::optional<ReliefMeasurement> measure_relief(const PlaneObservations& tiles,
                                                              const PlaneSolution& solution,
                                                              const Eigen::Vector3d& translation);

/// Flow of tile `i` by the translation alone, px: the displacement for a relative change of its
/// inverse depth.
[[nodiscard]] inline Eigen::Vector2f parallax_px(const TileJacobian& jacobian,
                                                 const Eigen::Vector3f& translation,
                                                 std::size_t i) {
  return {jacobian.x(0)[i] * translation.x() + jacobian.x(1)[i] * translation.y() +
              jacobian.x(2)[i] * translation.z(),
          jacobian.y(0)[i] * translation.x() + jacobian.y(1)[i] * translation.y() +
              jacobian.y(2)[i] * translation.z()};
}

/// Kalman filter of the relief's variance. The noise along the epipolar lines may exceed the one
/// across, since coding errors follow the motion: the verdict considers that error without
/// estimating it (Schmidt 1966).
class ReliefFilter {
 public:
  /// RMS of a plane's tilt over RMS of the residual to the plane, for self-affine terrain of Hurst
  /// exponent 0.8 (natural terrain: 0.7 to 0.9, ratio 1.2 to 2.4), in a square window.
  static constexpr double kLinearRatio = 1.6;

  ReliefFilter();

  void update(const ReliefMeasurement& measurement);

  /// Standard deviation of the relief without the fitted plane, over height: one sigma above its
  /// estimate.
  [[nodiscard]] double ratio() const;
  /// False once one plane does not explain the images, until one does: by three standard deviations
  /// each.
  [[nodiscard]] bool is_flat() const { return is_flat_; }

 private:
  double variance_ = 0;       // ratio^2
  double sigma_;              // of `variance_` with isotropic noise
  double by_anisotropy_ = 0;  // d(variance_)/d(excess noise along over noise across)
  bool is_flat_ = true;
};

}  // namespace stillkite
