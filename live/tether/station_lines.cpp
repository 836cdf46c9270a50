#include "live/tether/station_lines.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <type_traits>

#include "live/tether/number_fields.hpp"

namespace stillkite {
namespace {

// Whole number of a field within [0, max].
std::optional<std::uint32_t> whole(double value, double max) {
  if (value < 0 || value > max || value != std::floor(value)) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

constexpr double kMaxMode = 1e6;

std::optional<StationMessage> read_station_status(std::string_view fields) {
  constexpr double kMaxLength_counts = 1e6;  // 2.85 km
  const auto numbers = number_fields<4>(fields);
  if (!numbers) return std::nullopt;
  const auto [mode, runtime_s, battery, length] = *numbers;
  const auto mode_number = whole(mode, kMaxMode);
  if (!mode_number || std::abs(length) > kMaxLength_counts) return std::nullopt;
  return StationStatus{static_cast<int>(*mode_number), runtime_s, battery, length};
}

std::optional<StationMessage> read_attitude(std::string_view fields) {
  constexpr double kMaxNormError = 0.05;
  const auto numbers = number_fields<4>(fields);
  if (!numbers) return std::nullopt;
  const auto [w, x, y, z] = *numbers;
  const Eigen::Quaterniond q(w, x, y, z);
  if (!(std::abs(q.norm() - 1) < kMaxNormError)) return std::nullopt;
  return DroneAttitude{q.normalized()};
}

std::optional<StationMessage> read_position(std::string_view fields) {
  constexpr double kMaxElevation_rad = std::numbers::pi, kMaxAzimuth_rad = 1e3;
  const auto numbers = number_fields<3>(fields);
  if (!numbers) return std::nullopt;
  const auto [elevation_rad, azimuth_rad, barometer_m] = *numbers;
  if (std::abs(elevation_rad) > kMaxElevation_rad || std::abs(azimuth_rad) > kMaxAzimuth_rad) {
    return std::nullopt;
  }
  return DronePosition{elevation_rad, azimuth_rad, barometer_m};
}

std::optional<StationMessage> read_drone_status(std::string_view fields) {
  constexpr double kMaxFlags = 0x1FFF;  // 13 bits
  const auto numbers = number_fields<4>(fields);
  if (!numbers) return std::nullopt;
  const auto [mode, on_time_s, backup, flags] = *numbers;
  const auto mode_number = whole(mode, kMaxMode), bits = whole(flags, kMaxFlags);
  if (!mode_number || !bits) return std::nullopt;
  return DroneStatus{static_cast<int>(*mode_number), on_time_s, backup, *bits};
}

}  // namespace

std::optional<StationMessage> parse_station_line(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos || line[begin] != '!') return std::nullopt;
  line.remove_prefix(begin + 1);
  const std::string_view name = line.substr(0, line.find_first_of(kFieldSeparators));
  const std::string_view fields = line.substr(name.size());
  if (name == "GSStatus") return read_station_status(fields);
  if (name == "Attitude") return read_attitude(fields);
  if (name == "Pos") return read_position(fields);
  if (name == "FlightStatus") return read_drone_status(fields);
  return std::nullopt;
}

std::string station_line(const StationMessage& message) {
  return std::visit(
      [](const auto& m) {
        using M = std::decay_t<decltype(m)>;
        if constexpr (std::is_same_v<M, StationStatus>) {
          return fmt::format("!GSStatus {},{:.1f},{:.2f},{:.2f}\r\n", m.mode, m.runtime_s,
                             m.battery, m.relative_length_counts);
        } else if constexpr (std::is_same_v<M, DroneAttitude>) {
          const Eigen::Quaterniond& q = m.world_from_body;
          return fmt::format("!Attitude {:.6f},{:.6f},{:.6f},{:.6f}\r\n", q.w(), q.x(), q.y(),
                             q.z());
        } else if constexpr (std::is_same_v<M, DronePosition>) {
          return fmt::format("!Pos {:.5f},{:.5f},{:.3f}\r\n", m.elevation_from_zenith_rad,
                             m.azimuth_rad, m.barometer_m);
        } else {
          return fmt::format("!FlightStatus {},{:.1f},{:.2f},{}\r\n", m.mode, m.on_time_s, m.backup,
                             m.fault_flags);
        }
      },
      message);
}

}  // namespace stillkite
