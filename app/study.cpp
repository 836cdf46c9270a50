#include "app/study.hpp"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "app/results_folder.hpp"
#include "io/config/config_binding.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

using Kind = ConfigNode::Kind;

/// A study as in its file.
struct StudyFile {
  StudyCommand command = StudyCommand::run;
  ConfigNode flights;
  ConfigNode configurations;
  ConfigNode seeds;
  ConfigNode settings;
  std::string estimators;
  ConfigNode metrics;
  std::optional<fs::path> out;

  static void fields(auto& self, auto&& field) {
    field("command", self.command, "subcommand of each job");
    field("flights", self.flights, "list of configuration files or patterns, or name: pattern");
    field("configurations", self.configurations, "name: {key: value}");
    field("seeds", self.seeds, "list of seeds, or {first, count}");
    field("settings", self.settings, "{key: value} of all jobs");
    field("estimators", self.estimators, "--estimators of compare");
    field("metrics", self.metrics, "list of figures of the results");
    field("out", self.out, "folder of the results");
  }
};

struct SeedRange {
  int first = 1;
  int count = 1;

  static void fields(auto& self, auto&& field) {
    field("first", self.first, kAnySeed, "first seed");
    field("count", self.count, Range{1, 100000}, "number of seeds");
  }
};

// Names are parts of file names.
void check_study_name(const ConfigNode& node, const std::string& key, const std::string& name) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  if (!name.empty() && name[0] != '.' && name.size() <= 80 && std::ranges::all_of(name, is_plain)) {
    return;
  }
  reject_value(
      node, key,
      fmt::format("'{}' cannot name a folder; use 1 to 80 letters, digits, '-', '_', '.'{}", name,
                  key == "flights" ? ", or give a name: {NAME: FILE}" : ""));
}

// Files that match the pattern, sorted; the path itself without a wildcard.
std::vector<fs::path> matching_files(const ConfigNode& node, const fs::path& pattern) {
  if (pattern.string().find_first_of("*?[") == std::string::npos) return {pattern};
  glob_t found{};
  std::vector<fs::path> files;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  globfree(&found);
  if (files.empty()) reject_value(node, "flights", pattern.string() + ": matches no file");
  return files;
}

void add_flight(std::vector<Study::Flight>& flights, const ConfigNode& node,
                const std::string& name, const std::string& group, const fs::path& config) {
  check_study_name(node, "flights", name);
  const auto same = std::ranges::find(flights, name, &Study::Flight::name);
  if (same != flights.end()) {
    reject_value(node, "flights",
                 fmt::format("{} and {} have the same name '{}'; give names: {{NAME: FILE}}",
                             same->config.string(), config.string(), name));
  }
  if (!fs::exists(config)) reject_value(node, "flights", config.string() + ": no such file");
  flights.push_back({.name = name, .group = group, .config = config});
}

std::vector<Study::Flight> read_flights(const ConfigNode& node) {
  std::vector<Study::Flight> flights;
  for (const auto& [name, pattern] : node.entries) {
    const fs::path path = read_path(pattern, "flights." + name);
    for (const fs::path& file : matching_files(pattern, path)) {
      add_flight(flights, pattern, file == path ? name : flight_name(file), name, file);
    }
  }
  const std::vector<ConfigNode> listed = node.kind == Kind::scalar ? std::vector{node} : node.items;
  for (const ConfigNode& item : listed) {
    for (const fs::path& file : matching_files(item, read_path(item, "flights"))) {
      add_flight(flights, item, flight_name(file), flight_name(file), file);
    }
  }
  return flights;
}

std::vector<Study::Configuration> read_configurations(const ConfigNode& node) {
  if (node.kind == Kind::null) return {{.name = "", .settings = {}}};
  if (node.kind != Kind::map || node.entries.empty()) {
    reject_value(node, "configurations", "expected NAME: {key: value} for each configuration");
  }
  std::vector<Study::Configuration> configurations;
  for (const auto& [name, settings] : node.entries) {
    check_study_name(settings, "configurations", name);
    if (settings.kind != Kind::map && settings.kind != Kind::null) {
      reject_value(settings, "configurations." + name, "expected a group of keys {key: value}");
    }
    configurations.push_back({.name = name, .settings = settings});
  }
  return configurations;
}

std::vector<ConfigNode> read_seeds(const ConfigNode& node) {
  if (node.kind == Kind::null) return {};
  if (node.kind == Kind::list) {
    for (const ConfigNode& seed : node.items) (void)read_integer(seed, "seeds", kAnySeed);
    if (node.items.empty()) reject_value(node, "seeds", "the list is empty");
    return node.items;
  }
  if (node.kind != Kind::map) {
    reject_value(node, "seeds", "expected a list [1, 2] or {first: 1, count: 2}");
  }
  SeedRange range;
  read_fields(node, "seeds.", range);
  std::vector<ConfigNode> seeds;
  for (int i = 0; i < range.count; ++i) {
    ConfigNode seed = node;
    seed.kind = Kind::scalar;
    seed.entries.clear();
    seed.text = std::to_string(std::int64_t{range.first} + i);
    seeds.push_back(std::move(seed));
  }
  return seeds;
}

std::vector<StudyMetric> default_metrics(StudyCommand command) {
  switch (command) {
    case StudyCommand::run:
    case StudyCommand::compare:
      return {{.figure = "evaluation.position_rmse_m"},
              {.figure = "evaluation.drift_percent"},
              {.figure = "evaluation.tilt_rmse_rad"},
              {.figure = "evaluation.yaw_rmse_rad"},
              {.figure = "frames.rejected"},
              {.figure = "timing.frame_ms.median"}};
    case StudyCommand::hover:
      return {{.figure = "table.on.all.mean_m"},
              {.figure = "table.on.all.max_m"},
              {.figure = "estimate.position_rmse_m"},
              {.figure = "estimate.velocity_rmse_m_s"},
              {.figure = "estimate.nees_mean"},
              {.figure = "estimate.available_ratio", .worst = WorstValue::lowest}};
    case StudyCommand::simulate:
      return {};
  }
  return {};
}

std::vector<StudyMetric> read_metrics(const ConfigNode& node, StudyCommand command) {
  if (node.kind == Kind::null) return default_metrics(command);
  if (node.kind != Kind::list) {
    reject_value(node, "metrics",
                 "expected a list of figures, such as [evaluation.position_rmse_m, {figure: "
                 "estimate.available_ratio, worst: lowest}]");
  }
  std::vector<StudyMetric> metrics;
  for (const ConfigNode& item : node.items) {
    StudyMetric metric;
    if (item.kind == Kind::map) {
      read_fields(item, "metrics.", metric);
    } else {
      metric.figure = read_string(item, "metrics");
    }
    metrics.push_back(std::move(metric));
  }
  return metrics;
}

}  // namespace

Study read_study(const fs::path& file, const std::vector<std::string>& overrides) {
  const auto read = bind_config<StudyFile>(read_config(file, overrides));
  Study study{.command = read.command,
              .flights = read_flights(read.flights),
              .configurations = read_configurations(read.configurations),
              .seeds = read_seeds(read.seeds),
              .settings = read.settings,
              .estimators = read.estimators,
              .metrics = read_metrics(read.metrics, read.command),
              .out = read.out};
  if (study.flights.empty()) {
    throw InputError(file.string() + ": flights: missing; expected a list of configuration files");
  }
  if (read.settings.kind != Kind::map && read.settings.kind != Kind::null) {
    reject_value(read.settings, "settings", "expected a group of keys {key: value}");
  }
  if (!study.estimators.empty() && study.command != StudyCommand::compare) {
    throw InputError(fmt::format("{}: estimators: only with command: compare, not {}",
                                 file.string(), name_of(study.command)));
  }
  return study;
}

}  // namespace stillkite
