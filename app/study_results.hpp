#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "app/job_list.hpp"
#include "app/job_record.hpp"

namespace stillkite {

/// Record of the job as it is now; nullopt if it has to run.
[[nodiscard]] std::optional<JobRecord> record_of(const Study& study, const Job& job,
                                                 const JobFiles& files);

/// study.json: metrics, one entry per job (of `compare` per estimator), worst first, and groups of
/// jobs with the statistics of each metric (app/study_statistics.hpp).
[[nodiscard]] nlohmann::json study_json(const Study& study, std::span<const Job> jobs,
                                        const std::filesystem::path& folder);

/// One row per job with all numbers of its results.
[[nodiscard]] std::string study_csv(const nlohmann::json& study);

}  // namespace stillkite
