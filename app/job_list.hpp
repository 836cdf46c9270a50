#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/study.hpp"

namespace stillkite {

/// One flight with one configuration and one seed.
struct Job {
  std::string id;  ///< FLIGHT[-CONFIGURATION][-SEED]; names its files
  std::string flight;
  std::string flight_group;
  std::string configuration;
  std::string seed;         ///< empty: the configuration's own
  std::string config_yaml;  ///< effective configuration, independent of other YAML files
  std::vector<std::filesystem::path> inputs;
  /// Digest of subcommand, effective configuration, input files and program. A job whose results
  /// carry it is finished.
  std::string hash;
};

/// Files of a job in the folder of its study.
struct JobFiles {
  JobFiles(const std::filesystem::path& study_folder, const std::string& id);

  std::filesystem::path config;    ///< jobs/ID.yaml
  std::filesystem::path record;    ///< jobs/ID.json, written when the job ends
  std::filesystem::path messages;  ///< jobs/ID.txt, its stderr
  std::filesystem::path results;   ///< jobs/ID/
};

/// Every `count`-th job of a study, from the `index`-th.
struct Shard {
  int index = 1;  ///< 1 to count
  int count = 1;
};

/// K/N; throws InputError unless 1 <= K <= N.
[[nodiscard]] Shard read_shard(const std::string& text);

/// Jobs of a study, seeds innermost; only inputs of the shard are read. `program`: digest of the
/// executable. Throws InputError on an invalid configuration and on two jobs with the same ID.
[[nodiscard]] std::vector<Job> make_jobs(const Study& study, const std::string& program,
                                         Shard shard = {});

/// Arguments of this program for a job.
[[nodiscard]] std::vector<std::string> arguments_of(const Study& study, const JobFiles& files);

}  // namespace stillkite
