#include "io/import/imu_series.hpp"

namespace stillkite {

TimeSeries<Vector6d> imu_series(const ImportedFlight& flight) {
  constexpr double kMaxForceGap_s = 0.2, kMaxRate_rad_s = 100;
  const TimeSeries<Eigen::Vector3d>& rate = flight.angular_rate_in_body_rad_s;
  const TimeSeries<Eigen::Vector3d>& force = flight.specific_force_in_body_m_s2;
  TimeSeries<Vector6d> out;
  std::size_t after = 0;  // first reading of the accelerometer that is not before the rate
  for (std::size_t i = 0; i < rate.stamps.size(); ++i) {
    const Timestamp now = rate.stamps[i];
    if (rate.values[i].cwiseAbs().maxCoeff() > kMaxRate_rad_s) continue;
    while (after < force.stamps.size() && force.stamps[after] < now) ++after;
    if (after == force.stamps.size()) break;
    Eigen::Vector3d value = force.values[after];
    if (force.stamps[after] != now) {
      if (after == 0) continue;
      const double gap_s = seconds_between(force.stamps[after - 1], force.stamps[after]);
      if (gap_s > kMaxForceGap_s) continue;
      const double share = seconds_between(force.stamps[after - 1], now) / gap_s;
      value = (1 - share) * force.values[after - 1] + share * value;
    }
    Vector6d row;
    row << rate.values[i], value;
    out.stamps.push_back(now);
    out.values.push_back(row);
  }
  return out;
}

}  // namespace stillkite
