#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/time.hpp"
#include "io/dataset/sensor_log.hpp"

// Rotations of the images and of a gyroscope over the same intervals.

namespace stillkite {

/// Rotation of the body between two frames, estimated from the images alone.
struct ObservedRotation {
  Timestamp from;
  Timestamp to;
  /// Rotation vector.
  Eigen::Vector3d rotation_in_body_rad = Eigen::Vector3d::Zero();
};

/// Minimum interval of a comparison.
inline constexpr double kMinRotationInterval_s = 0.1;

/// Minimum mean rotation of the images for a comparison, RMS.
inline constexpr double kMinRotationRate_rad_s = 0.5 * kDegree;

/// Adds up consecutive image rotations to at least kMinRotationInterval_s: at 240 frames per second
/// the noise of one frame exceeds its rotation. Rotations faster than 5 rad/s are rejected.
[[nodiscard]] std::vector<ObservedRotation> merged_rotations(
    std::span<const ObservedRotation> observed);

/// Integral of the angular rate over a log, linear between readings. Refers to the log.
class GyroIntegral {
 public:
  explicit GyroIntegral(const TimeSeries<Eigen::Vector3d>& gyro);

  /// Rotation vector between two stamps; nullopt outside the log and over its gaps.
  [[nodiscard]] std::optional<Eigen::Vector3d> between(Timestamp from, Timestamp to) const;

 private:
  struct Sum {
    Eigen::Vector3d rotation_rad;
    int gaps = 0;
  };

  [[nodiscard]] std::optional<Sum> at(Timestamp stamp) const;

  const std::vector<Timestamp>& stamps_;
  double max_gap_s_;
  std::vector<Sum> at_;
};

/// Sums over intervals of image rotations p and gyroscope rotations g, both less their mean rate:
/// that of the gyroscope includes its bias.
struct RotationSums {
  Eigen::Matrix3d pg = Eigen::Matrix3d::Zero();  ///< sum of p g^T
  Eigen::Matrix3d gg = Eigen::Matrix3d::Zero();  ///< sum of g g^T
  double pp = 0;                                 ///< sum of |p|^2
  double time_s = 0;
  int count = 0;
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();  ///< mean rate of g less that of p

  /// 1 - sum |p - s M g|^2 / sum |p|^2, with orthogonal M and scale s.
  [[nodiscard]] double explained_fraction(const Eigen::Matrix3d& M, double scale = 1) const;

  /// The scale of least squares for the axes M.
  [[nodiscard]] double best_scale(const Eigen::Matrix3d& M) const;
  /// The explained fraction at that scale, 0 if it is negative: squared correlation.
  [[nodiscard]] double explained_at_best_scale(const Eigen::Matrix3d& M) const;

  /// RMS of the rotations per second.
  [[nodiscard]] double image_rate_rad_s() const;
  [[nodiscard]] double gyro_rate_rad_s() const;
};

/// `offset_s`: of the log ahead of the images.
[[nodiscard]] RotationSums rotation_sums(const GyroIntegral& gyro,
                                         std::span<const ObservedRotation> intervals,
                                         double offset_s);

/// Orthogonal M that minimizes sum |p - M g|^2 (Schönemann 1966).
[[nodiscard]] Eigen::Matrix3d best_axes(const RotationSums& sums);

/// The nearest proper rotation instead (Kabsch 1976).
[[nodiscard]] Eigen::Matrix3d best_rotation(const RotationSums& sums);

struct ClockOffset {
  double offset_s = 0;  ///< of the log ahead of the images
  double sigma_s = 0;
  double explained = 0;
};

/// Offsets of the search, in both directions from the centre.
struct OffsetSearch {
  double centre_s = 0;
  double range_s = 5;
  bool any_axes = false;  ///< at each offset with the axes and the scale that explain most
};

/// Least squares over the offsets of the search, each with at least `min_pairs` intervals. Of
/// several that explain a periodic motion, the nearest to the centre.
[[nodiscard]] ClockOffset clock_offset(const GyroIntegral& gyro,
                                       std::span<const ObservedRotation> intervals, int min_pairs,
                                       const OffsetSearch& search = {});

}  // namespace stillkite
