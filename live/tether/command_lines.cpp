#include "live/tether/command_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "live/tether/number_fields.hpp"

namespace stillkite {
namespace {

constexpr double kMaxInterval_s = 0.1;  // of pulses, also the first one

double limited(double rate, double limit) {
  return std::isfinite(rate) ? std::clamp(rate, -limit, limit) : 0;
}

double inverted(double rate, bool is_inverted) {
  return is_inverted ? -rate : rate;
}

}  // namespace

double DeadZoneStepper::step(double velocity, double dt_s) {
  owed_ += last_error_ * dt_s;
  last_error_ = 0;
  if (velocity == 0 || std::abs(velocity) >= dead_zone_) {
    owed_ = 0;
    return velocity;
  }
  // nearest of 0 and +-dead_zone to the velocity that removes the error
  const double wanted = velocity + (dt_s > 0 ? owed_ / dt_s : 0);
  const double pulse = std::abs(wanted) < dead_zone_ / 2 ? 0 : std::copysign(dead_zone_, wanted);
  last_error_ = velocity - pulse;
  return pulse;
}

std::string CommandLines::lines(const TetherCommand& command, Timestamp now) {
  const double dt_s =
      last_ ? std::clamp(seconds_between(*last_, now), 0.0, kMaxInterval_s) : kMaxInterval_s;
  last_ = now;
  const double elevation_rad_s = limited(command.elevation_rate_rad_s, kStationElevationRate_rad_s);
  const double azimuth_rad_s = limited(command.azimuth_rate_rad_s, kStationAzimuthRate_rad_s);
  const double yaw_rad_s = limited(command.yaw_rate_rad_s, kStationYawRate_rad_s);
  const double length_counts_s = length_.step(
      limited(command.length_rate_m_s / config_.m_per_count, kStationLengthVelocity_counts_s),
      dt_s);
  if (config_.format == TetherFormat::json) {
    return fmt::format(
        "{{\"schema\":1,\"length_rate\":{:.5f},\"elevation_rate\":{:.5f},\"azimuth_rate\":{:.5f},"
        "\"yaw_rate\":{:.5f}}}\n",
        length_counts_s * config_.m_per_count, elevation_rad_s, azimuth_rad_s, yaw_rad_s);
  }
  // + 0.0: no minus sign before a zero
  return fmt::format("Pos2 {:.4f},{:.4f},{:.2f}\nYaw {:.4f}\n",
                     inverted(-elevation_rad_s, config_.invert_elevation) + 0.0,
                     inverted(azimuth_rad_s, config_.invert_azimuth) + 0.0, length_counts_s + 0.0,
                     inverted(yaw_rad_s, config_.invert_yaw) + 0.0);
}

ParsedCommand parse_command_line(std::string_view line, double m_per_count) {
  constexpr std::string_view kPosition = "Pos2 ", kYaw = "Yaw ";
  ParsedCommand out;
  if (line.starts_with(kPosition)) {
    if (const auto rates = number_fields<3>(line.substr(kPosition.size()))) {
      out.position = TetherCommand{.length_rate_m_s = (*rates)[2] * m_per_count,
                                   .elevation_rate_rad_s = -(*rates)[0],
                                   .azimuth_rate_rad_s = (*rates)[1]};
    }
  } else if (line.starts_with(kYaw)) {
    if (const auto rate = number_fields<1>(line.substr(kYaw.size())))
      out.yaw_rate_rad_s = (*rate)[0];
  }
  return out;
}

}  // namespace stillkite
