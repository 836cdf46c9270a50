#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/time.hpp"
#include "live/tether_config.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// Limits of the Fotokite ground station's commands.
inline constexpr double kStationElevationRate_rad_s = 0.25;
inline constexpr double kStationAzimuthRate_rad_s = 0.2;
inline constexpr double kStationYawRate_rad_s = 0.4;
inline constexpr double kStationLengthVelocity_counts_s = 10'000;

/// Velocity of a motor that stands still below its dead zone: v from the dead zone on, below it
/// pulses of +-dead_zone whose mean is v, with a position error of at most half a pulse.
class DeadZoneStepper {
 public:
  explicit DeadZoneStepper(double dead_zone) : dead_zone_(dead_zone) {}

  /// Velocity for the interval that begins now, as long as the last one of `dt_s`. Zero stops at
  /// once and discards the position error.
  [[nodiscard]] double step(double velocity, double dt_s);

 private:
  double dead_zone_;
  double owed_ = 0;        // position error of the pulses
  double last_error_ = 0;  // velocity error of the current interval
};

/// Commands as the ground station's lines, or as JSON lines. Rates are limited to those of the
/// station; rates that are not finite are zero.
class CommandLines {
 public:
  explicit CommandLines(const TetherConfig& config)
      : config_(config), length_(config.dead_zone_counts_s) {}

  /// Fotokite: Pos2 elevRate,azRate,lenVel and Yaw rate, in rad/s and counts/s. elevRate has the
  /// sign of !Pos, minus that of the elevation above the horizontal.
  [[nodiscard]] std::string lines(const TetherCommand& command, Timestamp now);

 private:
  TetherConfig config_;
  DeadZoneStepper length_;
  std::optional<Timestamp> last_;
};

/// Command of a Pos2 line: length rate by `m_per_count`, yaw not set; or of a Yaw line.
struct ParsedCommand {
  std::optional<TetherCommand> position;
  std::optional<double> yaw_rate_rad_s;
};
/// Inverse of `CommandLines` for one line of format fotokite without inversions, as a simulated
/// station reads it; empty for any other line.
[[nodiscard]] ParsedCommand parse_command_line(std::string_view line, double m_per_count);

}  // namespace stillkite
