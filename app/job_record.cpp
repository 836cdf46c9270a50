#include "app/job_record.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

constexpr int kJobSchema = 1;

}  // namespace

void write_job_record(const std::filesystem::path& file, const JobRecord& record) {
  write_file(file, json_text({{"schema_version", kJobSchema},
                              {"hash", record.hash},
                              {"failure", record.failure ? nlohmann::json(*record.failure)
                                                         : nlohmann::json(nullptr)},
                              {"wall_s", record.wall_s}}) +
                       '\n');
}

std::optional<JobRecord> read_job_record(const std::filesystem::path& file,
                                         const std::string& hash) {
  const auto read = nlohmann::json::parse(std::ifstream(file), nullptr, false);
  if (!read.is_object() || read.value("schema_version", nlohmann::json()) != kJobSchema ||
      read.value("hash", nlohmann::json()) != hash) {
    return std::nullopt;
  }
  JobRecord record{.hash = hash, .failure = std::nullopt};
  const nlohmann::json failure = read.value("failure", nlohmann::json());
  if (failure.is_string()) record.failure = failure.get<std::string>();
  const nlohmann::json wall_s = read.value("wall_s", nlohmann::json());
  if (wall_s.is_number()) record.wall_s = wall_s.get<double>();
  return record;
}

}  // namespace stillkite
