#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "estimation/sliding_window/imu_preintegration.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Mean readings of an IMU over the interval (from, to] of its clock.
struct ImuInterval {
  Timestamp from;
  Timestamp to;
  Eigen::Vector3d angular_rate_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();
};

/// IMU readings by time: an interval between two images can be taken again when the offset of the
/// clocks is known better, or when late readings have arrived.
class ImuTimeline {
 public:
  /// `initial`: is held before the first reading.
  explicit ImuTimeline(const ImuInterval& initial = {}) : held_(initial) {}

  /// Appends readings, ascending and without overlap; earlier ones are left out.
  void add(std::span<const ImuInterval> readings);

  /// Samples of an interval. Where no reading is known the one before is held, as a gap.
  [[nodiscard]] std::vector<ImuSample> between(Timestamp from, Timestamp to) const;

  /// Readings at a time; the nearest ones before outside the known intervals.
  [[nodiscard]] const ImuInterval& at(Timestamp stamp) const;

  /// End of the last reading.
  [[nodiscard]] Timestamp end() const { return readings_.empty() ? held_.to : readings_.back().to; }

  void forget_before(Timestamp stamp);

 private:
  ImuInterval held_;  // before the first one
  std::vector<ImuInterval> readings_;
};

}  // namespace stillkite
