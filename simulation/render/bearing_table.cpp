#include "simulation/render/bearing_table.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr int kCoefficients = 4;

// Cubic interpolation at the Chebyshev nodes of the segment: near-minimal maximum error.
BearingSegment fit_segment(const Camera& camera, const LensError& lens_error, double middle_column,
                           double row) {
  Eigen::Matrix4d powers;
  Eigen::Matrix<double, kCoefficients, 2> bearings;
  for (int node = 0; node < kCoefficients; ++node) {
    const double t =
        0.5 * BearingSegment::kColumns * std::cos((node + 0.5) * std::numbers::pi / kCoefficients);
    powers.row(node) << 1, t, t * t, t * t * t;
    constexpr double kNoBearing = std::numeric_limits<double>::quiet_NaN();
    const std::optional<Eigen::Vector2d> bearing =
        bearing_of(camera, lens_error, {middle_column + t, row});
    bearings.row(node) = bearing.value_or(Eigen::Vector2d::Constant(kNoBearing));
  }
  const Eigen::Matrix<float, kCoefficients, 2> cubic =
      powers.partialPivLu().solve(bearings).cast<float>();
  BearingSegment segment;
  for (int k = 0; k < kCoefficients; ++k) {
    segment.x[k] = cubic(k, 0);
    segment.y[k] = cubic(k, 1);
  }
  return segment;
}

}  // namespace

void check_rendering(const Camera& camera, int supersampling) {
  if (camera.width_px < 1 || camera.height_px < 1 || !(camera.focal_x_px > 0) ||
      !(camera.focal_y_px > 0)) {
    throw InputError("camera: width, height and focal lengths must be > 0");
  }
  if (supersampling < 1 || supersampling > kMaxSupersampling) {
    throw InputError("supersampling: " + std::to_string(supersampling) + " is not in 1 to 4");
  }
}

BearingTable tabulate_bearings(const Camera& camera, const LensError& lens_error,
                               int supersampling) {
  check_rendering(camera, supersampling);
  constexpr int kColumns = BearingSegment::kColumns;
  BearingTable table{.supersampling = supersampling,
                     .segments_a_row = (camera.width_px + kColumns - 1) / kColumns,
                     .segments = {}};
  for (int row = 0; row < camera.height_px; ++row) {
    for (int sample = 0; sample < table.samples_a_pixel(); ++sample) {
      const double sample_row = row + sample_offset(sample, supersampling).down;
      for (int segment = 0; segment < table.segments_a_row; ++segment) {
        const double middle_column = segment * kColumns + 0.5 * (kColumns - 1);
        table.segments.push_back(fit_segment(camera, lens_error, middle_column, sample_row));
      }
    }
  }
  return table;
}

}  // namespace stillkite
