#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace stillkite {

/// Result of a job that has ended.
struct JobRecord {
  std::string hash;                    ///< Job::hash
  std::optional<std::string> failure;  ///< message; nullopt: finished
  double wall_s = 0;
};

/// Writes the record, complete or not at all; throws as write_file.
void write_job_record(const std::filesystem::path& file, const JobRecord& record);

/// Record of a file with this hash; nullopt without a file, for another hash, and for a file of
/// another schema version.
[[nodiscard]] std::optional<JobRecord> read_job_record(const std::filesystem::path& file,
                                                       const std::string& hash);

}  // namespace stillkite
