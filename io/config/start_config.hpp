#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

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
  double ground_z_m = 0;

  static void fields(auto& self, auto&& field) {
    field("path", self.path, "EuRoC or TUM trajectory; without it the data set's own, if any");
    field("ground_z_m", self.ground_z_m, Range{-1e5, 1e5},
          "where the ground is in the truth's world; ours has it at z = 0");
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
          "start from the truth's first pose, instead of the following");
    field("height_m", self.height_m, Range{.min = 0, .max = 1e5, .open_min = true},
          "of the body over the ground; without any height the unit is the initial height");
    field("yaw_deg", self.yaw_deg, "of the body, from the world's x to its y axis");
    field("pitch_deg", self.pitch_deg, Range{-90, 90}, "of the body, positive is nose down");
    field("roll_deg", self.roll_deg, Range{-180, 180}, "of the body, positive is right side down");
  }
};

struct HeightConfig {
  HeightSource source = HeightSource::none;
  std::optional<std::filesystem::path> path;

  static void fields(auto& self, auto&& field) {
    field("source", self.source,
          "what measures: range is the distance to the ground along the body's -z, barometer the "
          "change of its height");
    field("path", self.path, "CSV: timestamp [ns] or [s], height in m");
  }
};

struct LogConfig {
  std::optional<std::filesystem::path> path;

  static void fields(auto& self, auto&& field) {
    field("path", self.path, "CSV with a stamp first; without it nothing is used");
  }
};

}  // namespace stillkite
