#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "io/config/config_node.hpp"

namespace stillkite {

enum class StudyCommand { run, compare, hover, simulate };
template <>
struct EnumNames<StudyCommand> {
  static constexpr auto value = std::to_array<std::pair<StudyCommand, std::string_view>>(
      {{StudyCommand::run, "run"},
       {StudyCommand::compare, "compare"},
       {StudyCommand::hover, "hover"},
       {StudyCommand::simulate, "simulate"}});
};

/// Extreme of a figure that is its worst value.
enum class WorstValue { highest, lowest };
template <>
struct EnumNames<WorstValue> {
  static constexpr auto value = std::to_array<std::pair<WorstValue, std::string_view>>(
      {{WorstValue::highest, "highest"}, {WorstValue::lowest, "lowest"}});
};

/// Figure of the results that a study evaluates.
struct StudyMetric {
  std::string figure;  ///< dotted path in summary.json, such as evaluation.position_rmse_m
  WorstValue worst = WorstValue::highest;

  static void fields(auto& self, auto&& field) {
    field("figure", self.figure, "dotted path in the results");
    field("worst", self.worst, "worst value");
  }
};

/// Flights x configurations x seeds of one command.
struct Study {
  struct Flight {
    std::string name;
    std::string group;  ///< name given to several files by one pattern, else the flight's name
    std::filesystem::path config;
  };
  struct Configuration {
    std::string name;  ///< empty: the only one, without settings
    ConfigNode settings;
  };

  StudyCommand command = StudyCommand::run;
  std::vector<Flight> flights;
  std::vector<Configuration> configurations;  ///< at least one
  std::vector<ConfigNode> seeds;              ///< integers; empty: the seed of the configuration
  ConfigNode settings;                        ///< common to all, before those of a configuration
  std::string estimators;                     ///< of `compare`; empty: all policies
  std::vector<StudyMetric> metrics;
  std::optional<std::filesystem::path> out;
};

/// Reads a study file with overrides key=value. Paths are relative to the file; a flight may be a
/// glob pattern. Throws InputError with file, line, key, value and the allowed ones.
[[nodiscard]] Study read_study(const std::filesystem::path& file,
                               const std::vector<std::string>& overrides);

}  // namespace stillkite
