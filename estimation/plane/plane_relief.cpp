#include "estimation/plane/plane_relief.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

// Terrain of this relief tilts the plane by 2.5 times it over the half width of the image (Hurst
// exponent 0.8): 0.1 rad and more, where the first-order model of the tilt ends.
constexpr double kMaxRelief = 0.03;

constexpr double kSigmas = 3;

// Standard deviation of the excess noise along the epipolar lines over the noise across, as at
// night behind H.264.
constexpr double kAnisotropy = 0.5;

// Relative variance, times the sample size, of a variance from the median absolute deviation: 2
// over its efficiency of 37 %.
constexpr double kMadVariance = 5.4;

// Median of chi-square with one degree of freedom.
constexpr double kMedianSquaredNormal = 0.4549364;

}  // namespace

std::optional<ReliefMeasurement> measure_relief(const PlaneObservations& tiles,
                                                const PlaneSolution& solution,
                                                const Eigen::Vector3d& translation) {
  constexpr std::size_t kMinTiles = 20;
  constexpr float kMinParallax_px = 0.1F;
  constexpr double kMaxNoise = 0.04;  // of a tile, 0.2 of the parallax
  const TileMeasurements& m = tiles.measurements;
  const Eigen::Vector3f t = translation.cast<float>();
  const Eigen::Matrix<float, 8, 1> step = step_without_prior(solution).cast<float>();
  std::vector<float> parallaxes, along, across, noise_ratios;
  for (std::size_t i = 0; i < static_cast<std::size_t>(tiles.jacobian.count); ++i) {
    if (!(tiles.trace(i) > tiles.min_trace())) continue;
    const Eigen::Vector2f parallax = parallax_px(tiles.jacobian, t, i);
    const float length = parallax.norm();
    if (length < kMinParallax_px) continue;
    float ux = 0, uy = 0;
    for (int a = 0; a < 8; ++a) {
      ux += tiles.jacobian.x(a)[i] * step[a];
      uy += tiles.jacobian.y(a)[i] * step[a];
    }
    const float ex = m.gx[i] - m.gxx[i] * ux - m.gxy[i] * uy;
    const float ey = m.gy[i] - m.gxy[i] * ux - m.gyy[i] * uy;
    const float dx = parallax.x() / length, dy = parallax.y() / length;
    const float g_along = dx * dx * m.gxx[i] + 2 * dx * dy * m.gxy[i] + dy * dy * m.gyy[i];
    const float g_across = dy * dy * m.gxx[i] - 2 * dx * dy * m.gxy[i] + dx * dx * m.gyy[i];
    if (std::min(g_along, g_across) < 0.25F * tiles.min_trace()) continue;
    parallaxes.push_back(length);
    const float error_along = (dx * ex + dy * ey) / (g_along * length);
    const float error_across = (dx * ey - dy * ex) / (g_across * length);
    along.push_back(error_along * error_along);
    across.push_back(error_across * error_across);
    noise_ratios.push_back(g_across / g_along);
  }
  if (along.size() < kMinTiles) return std::nullopt;
  const double clusters =
      std::min<double>(static_cast<double>(along.size()), PlaneObservations::kClusters);
  const double explained = upper_median(along) / kMedianSquaredNormal;
  // pixel noise depends on the texture's direction, errors of lens and shutter do not
  const double noise = upper_median(across) / kMedianSquaredNormal *
                       std::max(1.0, static_cast<double>(upper_median(noise_ratios)));
  // the estimated translation of a rotation is noise, to which the residuals are correlated
  if (noise > kMaxNoise) return std::nullopt;
  return ReliefMeasurement{.variance = explained - noise,
                           .sigma = noise * std::sqrt(2 * kMadVariance / clusters),
                           .across = noise,
                           .parallax_px = static_cast<double>(upper_median(parallaxes))};
}

bool is_in_range(const ReliefMeasurement& measurement, double relief_ratio) {
  constexpr double kRange_px = 1;
  return std::max(kMaxRelief, relief_ratio) * measurement.parallax_px < kRange_px;
}

ReliefFilter::ReliefFilter() : sigma_(kMaxRelief * kMaxRelief) {}

// Residuals beyond the range of Lucas-Kanade are underestimated: evidence for relief, not against
// it.
void ReliefFilter::update(const ReliefMeasurement& measurement) {
  constexpr double kChange = 1.0 / 30;  // of the relief, per frame
  constexpr double kMinSigma = 1e-9;    // images without noise
  constexpr double kMaxResidual_px = 0.4;
  const double innovation = measurement.variance - variance_;
  const double residual_px =
      measurement.parallax_px * std::sqrt(std::max(0.0, measurement.variance + measurement.across));
  const bool is_underestimated =
      residual_px > kMaxResidual_px || !is_in_range(measurement, ratio());
  if (innovation < 0 && is_underestimated) return;
  const double noise = std::max(kMinSigma, measurement.sigma);
  double sigma = std::hypot(sigma_, kChange * variance_);
  const double by_anisotropy = kAnisotropy * (measurement.across - by_anisotropy_);
  if (std::abs(innovation) > kSigmas * std::hypot(sigma, noise, by_anisotropy)) {
    sigma = std::abs(innovation);  // other ground
  }
  const double gain = sigma * sigma / (sigma * sigma + noise * noise);
  variance_ += gain * innovation;
  by_anisotropy_ += gain * (measurement.across - by_anisotropy_);
  sigma_ = std::sqrt(1 - gain) * sigma;
  const double margin = kSigmas * std::hypot(sigma_, kAnisotropy * by_anisotropy_);
  is_flat_ = variance_ + (is_flat_ ? -margin : margin) < kMaxRelief * kMaxRelief;
}

double ReliefFilter::ratio() const {
  return std::sqrt(std::max(0.0, variance_) + sigma_);
}

}  // namespace stillkite
