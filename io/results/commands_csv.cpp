#include "io/results/commands_csv.hpp"

#include <fmt/format.h>

namespace stillkite {

std::string commands_csv_header() {
  return "#timestamp [ns],action,reason,length_rate [m/s],elevation_rate [rad/s],"
         "azimuth_rate [rad/s],yaw_rate [rad/s],home_x [m],home_y [m],home_z [m],turn_home [rad]\n";
}

std::string commands_csv_row(Timestamp stamp, const HoldDecision& decision) {
  const TetherCommand& c = decision.command;
  const Eigen::Vector3d& home = decision.position_error_in_station_m;
  return fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", stamp.ns,
                     name_of(decision.action), name_of(decision.reason), c.length_rate_m_s,
                     c.elevation_rate_rad_s, c.azimuth_rate_rad_s, c.yaw_rate_rad_s, home.x(),
                     home.y(), home.z(), decision.yaw_error_rad);
}

}  // namespace stillkite
