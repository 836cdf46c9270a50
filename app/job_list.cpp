#include "app/job_list.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <sstream>

#include "app/effective_config.hpp"
#include "io/file_digest.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

// Increment it when equal inputs give other result files.
constexpr int kHashVersion = 1;

/// Digests of files, each computed once: jobs share their flights.
class InputDigests {
 public:
  std::string of(const std::vector<fs::path>& files) {
    std::string text;
    for (const fs::path& file : files) {
      const auto [at, is_new] = digests_.try_emplace(file);
      if (is_new) at->second = file_digest(file);
      text += file.string() + ' ' + at->second + '\n';
    }
    return text;
  }

 private:
  std::map<fs::path, std::string> digests_;
};

ConfigNode document_of(const Study& study, const Study::Flight& flight,
                       const Study::Configuration& configuration, const ConfigNode* seed) {
  ConfigNode root = read_config(flight.config, {});
  apply_settings(root, study.settings);
  apply_settings(root, configuration.settings);
  if (seed != nullptr) {
    apply_settings(root, {.kind = ConfigNode::Kind::map, .entries = {{"seed", *seed}}});
  }
  return root;
}

}  // namespace

JobFiles::JobFiles(const fs::path& study_folder, const std::string& id)
    : config(study_folder / "jobs" / (id + ".yaml")),
      record(study_folder / "jobs" / (id + ".json")),
      messages(study_folder / "jobs" / (id + ".txt")),
      results(study_folder / "jobs" / id) {}

Shard read_shard(const std::string& text) {
  std::istringstream stream(text);
  Shard shard;
  char slash = ' ';
  stream >> shard.index >> slash >> shard.count;
  if (!stream || !stream.eof() || slash != '/' || shard.index < 1 || shard.index > shard.count) {
    throw InputError(
        fmt::format("--shard: '{}'; expected K/N with K from 1 to N, such as 3/10", text));
  }
  return shard;
}

std::vector<Job> make_jobs(const Study& study, const std::string& program, Shard shard) {
  std::vector<Job> jobs;
  std::set<std::string> ids;
  const auto in_shard = [&](std::size_t position) {
    return static_cast<int>(position % static_cast<std::size_t>(shard.count)) == shard.index - 1;
  };
  InputDigests digests;
  const auto add_job = [&](const Study::Flight& flight, const Study::Configuration& configuration,
                           const ConfigNode* seed) {
    std::string id = flight.name;
    if (!configuration.name.empty()) id += '-' + configuration.name;
    if (seed != nullptr) id += '-' + seed->text;
    if (!ids.insert(id).second) {
      throw InputError("two jobs have the ID " + id +
                       "; rename a flight or configuration, or remove a repeated seed");
    }
    if (!in_shard(ids.size() - 1)) return;
    const EffectiveConfig config = effective_config(
        study.command, document_of(study, flight, configuration, seed), study.estimators);
    jobs.push_back({.id = std::move(id),
                    .flight = flight.name,
                    .flight_group = flight.group,
                    .configuration = configuration.name,
                    .seed = seed != nullptr ? seed->text : "",
                    .config_yaml = config.yaml,
                    .inputs = config.inputs,
                    .hash = text_digest(fmt::format("{}\n{}\n{}\n{}\n{}\n{}", kHashVersion, program,
                                                    name_of(study.command), study.estimators,
                                                    config.yaml, digests.of(config.inputs)))});
  };
  for (const Study::Flight& flight : study.flights) {
    for (const Study::Configuration& configuration : study.configurations) {
      for (const ConfigNode& seed : study.seeds) add_job(flight, configuration, &seed);
      if (study.seeds.empty()) add_job(flight, configuration, nullptr);
    }
  }
  return jobs;
}

std::vector<std::string> arguments_of(const Study& study, const JobFiles& files) {
  std::vector<std::string> arguments{std::string(name_of(study.command)), files.config.string(),
                                     "--out", files.results.string()};
  if (study.command == StudyCommand::hover) {  // one job is one process with one thread
    arguments.insert(arguments.end(), {"--jobs", "1"});
  }
  if (!study.estimators.empty()) {
    arguments.insert(arguments.end(), {"--estimators", study.estimators});
  }
  return arguments;
}

}  // namespace stillkite
