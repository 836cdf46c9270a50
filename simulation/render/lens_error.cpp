#include "simulation/render/lens_error.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

constexpr int kOrder = 3;

// cos(k angle) for k = 0 to 3: Chebyshev polynomials of cos(angle).
std::array<double, kOrder + 1> cosines(double angle) {
  const double c = std::cos(angle);
  return {1, c, 2 * c * c - 1, c * (4 * c * c - 3)};
}

// Mean of cos(k u)^2 over the pixels of an image.
double mean_square(int k) {
  return k == 0 ? 1 : 0.5;
}

}  // namespace

Eigen::Vector2d LensError::at(const Eigen::Vector2d& pixel) const {
  const auto along_x = cosines((pixel.x() + 0.5) * std::numbers::pi / width_px);
  const auto along_y = cosines((pixel.y() + 0.5) * std::numbers::pi / height_px);
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  for (const Term& term : terms) error += along_x[term.i] * along_y[term.j] * term.amplitude_px;
  return error;
}

LensError random_lens_error(const Camera& camera, double rms_px, std::uint64_t seed) {
  LensError error{.width_px = camera.width_px, .height_px = camera.height_px};
  if (rms_px == 0) return error;
  Random random(seed);
  double power = 0;
  for (int i = 0; i <= kOrder; ++i) {
    for (int j = i == 0 ? 1 : 0; i + j <= kOrder; ++j) {
      const double x = random.normal();
      const double y = random.normal();
      error.terms.push_back({i, j, {x, y}});
      power += mean_square(i) * mean_square(j) * (x * x + y * y);
    }
  }
  for (LensError::Term& term : error.terms) term.amplitude_px *= rms_px / std::sqrt(power);
  return error;
}

std::optional<Eigen::Vector2d> bearing_of(const Camera& camera, const LensError& error,
                                          const Eigen::Vector2d& pixel) {
  return undistort(camera, error.terms.empty() ? pixel : pixel - error.at(pixel));
}

}  // namespace stillkite
