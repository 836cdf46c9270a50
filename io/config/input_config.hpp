#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "io/config/log_config.hpp"

namespace stillkite {

enum class HeightSource { none, range, barometer };
template <>
struct EnumNames<HeightSource> {
  static constexpr auto value = std::to_array<std::pair<HeightSource, std::string_view>>(
      {{HeightSource::none, "none"},
       {HeightSource::range, "range"},
       {HeightSource::barometer, "barometer"}});
};

struct TruthConfig {
  std::optional<std::filesystem::path> path;
  std::optional<std::filesystem::path> positions;
  std::optional<std::filesystem::path> velocity;
  double ground_z_m = 0;
  double time_offset_s = 0;
  double position_sigma_m = 0;
  double attitude_sigma_deg = 0;
  double velocity_sigma_m_s = 0;
  double angular_rate_sigma_deg_s = 0;

  static void fields(auto& self, auto&& field) {
    field("path", self.path,
          "EuRoC or TUM trajectory; default: the data set's ground truth, if any");
    field(
        "positions", self.positions,
        "instead of path, a truth without attitude (GNSS, prism): t, x, y, z; further columns are "
        "ignored");
    field("velocity", self.velocity,
          "true velocity: t, vx, vy, vz in the world, or a data set's velocity.csv");
    field(
        "ground_z_m", self.ground_z_m, Range{-1e5, 1e5},
        "height of the ground plane in the truth's world; subtracted, so that the ground is z = 0");
    field("time_offset_s", self.time_offset_s, Range{-1e9, 1e9}, "added to the truth's stamps");
    field("position_sigma_m", self.position_sigma_m, Range{0, 1e3},
          "standard deviation of the truth's positions, per axis");
    field("attitude_sigma_deg", self.attitude_sigma_deg, Range{0, 90},
          "standard deviation of the truth's attitude, per axis");
    field("velocity_sigma_m_s", self.velocity_sigma_m_s, Range{0, 1e3},
          "standard deviation of the true velocities, per axis");
    field("angular_rate_sigma_deg_s", self.angular_rate_sigma_deg_s, Range{0, 1e3},
          "standard deviation of the true angular rates, per axis");
  }
};

struct InitialConfig {
  bool from_truth = false;
  std::optional<double> height_m;
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;

  static void fields(auto& self, auto&& field) {
    field("from_truth", self.from_truth,
          "use the truth's pose at the first frame, instead of the following keys; without true "
          "attitude only its position");
    field("height_m", self.height_m, Range{.min = 0, .max = 1e5, .open_min = true},
          "height of the body above ground; without any height, lengths are in initial heights");
    field("yaw_deg", self.yaw_deg,
          "initial yaw of the body, positive from the world's x to its y axis");
    field("pitch_deg", self.pitch_deg, Range{-90, 90},
          "initial pitch of the body, positive nose down");
    field("roll_deg", self.roll_deg, Range{-180, 180},
          "initial roll of the body, positive right side down");
  }
};

struct HeightConfig {
  HeightSource source = HeightSource::none;
  std::optional<std::filesystem::path> path;
  double time_offset_s = 0;

  static void fields(auto& self, auto&& field) {
    field("source", self.source,
          "sensor type: range is the distance to the ground along the body's -z, barometer the "
          "relative height");
    field("path", self.path, "CSV: timestamp [ns] or [s], height [m]");
    field("time_offset_s", self.time_offset_s, kTimeOffset_s,
          "added to the log's stamps, so that they are on the clock of the images");
  }
};

}  // namespace stillkite
