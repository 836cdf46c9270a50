#include "app/study.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/job_list.hpp"
#include "app/job_record.hpp"
#include "app/study_results.hpp"
#include "app/study_statistics.hpp"
#include "app/study_table.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Names = std::vector<std::string>;

// Two hover flights and a recorded one.
void write_flights(const TemporaryFolder& folder) {
  folder.write("flights/calm.yaml", "plant_file: plant.yaml\ntrials: {on: 1, off: 0}\n");
  folder.write("flights/windy.yaml", "plant: {wind: {mean_m_s: 6, towards_deg: 90}}\n");
  folder.write("flights/video.yaml", "source: {path: video.mp4}\n");
  folder.write("flights/plant.yaml", "drone: {lag_s: 0.7}\n");
}

Study study_of(const TemporaryFolder& folder, const std::string& text,
               const Names& overrides = {}) {
  write_flights(folder);
  return read_study(folder.file("study.yaml", text), overrides);
}

Names ids_of(const std::vector<Job>& jobs) {
  Names ids;
  for (const Job& job : jobs) ids.push_back(job.id);
  return ids;
}

Names hashes_of(const Study& study, const std::string& program = "p") {
  Names hashes;
  for (const Job& job : make_jobs(study, program)) hashes.push_back(job.hash);
  return hashes;
}

std::string problem_of(const std::string& text) {
  const TemporaryFolder folder;
  return input_error_of(folder, [&] { (void)make_jobs(study_of(folder, text), ""); });
}

constexpr const char* kTwoByTwo =
    "command: hover\n"
    "flights: [flights/calm.yaml, flights/w*.yaml]\n"
    "configurations: {a: {}, b: {plant: {wind: {mean_m_s: 3}}}}\n"
    "seeds: {first: 7, count: 2}\n";

TEST(JobList, IsTheProductOfFlightsConfigurationsAndSeeds) {
  const TemporaryFolder folder;
  EXPECT_EQ(ids_of(make_jobs(study_of(folder, kTwoByTwo), "")),
            (Names{"calm-a-7", "calm-a-8", "calm-b-7", "calm-b-8", "windy-a-7", "windy-a-8",
                   "windy-b-7", "windy-b-8"}));
  EXPECT_EQ(ids_of(make_jobs(study_of(folder, "command: hover\nflights: flights/calm.yaml\n"), "")),
            Names{"calm"});
}

TEST(JobList, HasEachJobInOneShardWithTheSameHash) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, kTwoByTwo);
  const std::vector<Job> jobs = make_jobs(study, "");
  for (const int count : {1, 3, 10}) {
    for (int index = 1; index <= count; ++index) {
      std::size_t position = static_cast<std::size_t>(index) - 1;
      for (const Job& job : make_jobs(study, "", {.index = index, .count = count})) {
        ASSERT_LT(position, jobs.size());
        EXPECT_EQ(job.id, jobs[position].id);
        EXPECT_EQ(job.hash, jobs[position].hash);
        position += static_cast<std::size_t>(count);
      }
      EXPECT_GE(position, jobs.size()) << "a job is missing";
    }
  }
}

TEST(JobList, ReadsAShard) {
  const Shard shard = read_shard("3/10");
  EXPECT_EQ(shard.index, 3);
  EXPECT_EQ(shard.count, 10);
  for (const char* text : {"0/3", "4/3", "-1/3", "1", "1/", "a/b", "1/3x", "1/99999999999"}) {
    EXPECT_THROW((void)read_shard(text), InputError) << text;
  }
}

// Groups of keys are merged, as by --set plant.wind.mean_m_s=3.
TEST(JobList, SetsKeysInTheOrderFlightSettingsConfigurationSeed) {
  const TemporaryFolder folder;
  const Study study = study_of(
      folder, std::string(kTwoByTwo) + "settings: {plant.wind.mean_m_s: 4, trials.off: 2}\n");
  const std::vector<Job> jobs = make_jobs(study, "");
  const auto has = [&](std::size_t i, const char* text) {
    return jobs.at(i).config_yaml.find(text) != std::string::npos;
  };
  EXPECT_TRUE(has(4, "mean_m_s: 4 ")) << "settings over flight";
  EXPECT_TRUE(has(7, "mean_m_s: 3 ")) << "configuration over settings";
  EXPECT_TRUE(has(7, "towards_deg: 90 ")) << "other keys of the group stay";
  EXPECT_TRUE(has(7, "off: 2 "));
  EXPECT_TRUE(has(7, "seed: 8 "));
  EXPECT_TRUE(has(0, "lag_s: 0.7 ")) << "plant file";
  EXPECT_TRUE(has(0, "plant_file: null")) << "independent of other files";
}

TEST(JobList, ChangesTheHashOfTheJobsWithAChangedKeyOnly) {
  const TemporaryFolder folder;
  const Names before = hashes_of(study_of(folder, kTwoByTwo));
  EXPECT_EQ(before, hashes_of(study_of(folder, kTwoByTwo)));
  const Names after =
      hashes_of(study_of(folder, kTwoByTwo, {"configurations.b.plant.wind.mean_m_s=5"}));
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i] == after[i], i % 4 < 2) << i;
  }
}

TEST(JobList, ChangesTheHashWithTheProgramAndTheContentsOfAnInput) {
  const TemporaryFolder folder;
  const auto hash = [&](const std::string& image, const std::string& program) {
    folder.write("flights/ground.png", image);
    const Study study = study_of(folder,
                                 "command: simulate\nflights: {f: flights/f.yaml}\n"
                                 "settings: {ground.photograph: flights/ground.png}\n");
    return hashes_of(study, program).front();
  };
  folder.write("flights/f.yaml", "{seed: 1}\n");
  const std::string first = hash("one", "p");
  EXPECT_EQ(hash("one", "p"), first);
  EXPECT_NE(hash("two", "p"), first);
  EXPECT_NE(hash("one", "q"), first);
}

TEST(Study, NamesThePatternsGroupOfFlights) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, "command: hover\nflights: {all: 'flights/*m.yaml'}\n");
  ASSERT_EQ(study.flights.size(), 1U);
  EXPECT_EQ(study.flights[0].name, "calm");
  EXPECT_EQ(study.flights[0].group, "all");
}

TEST(Study, RejectsWrongKeysWithTheAllowedOnes) {
  const std::string flights = "command: hover\nflights: [flights/calm.yaml]\n";
  EXPECT_EQ(problem_of("flight: [a.yaml]\n"),
            "study.yaml:1:1: flight: unknown key, did you mean 'flights'?; known keys: command, "
            "flights, configurations, seeds, settings, estimators, metrics, out");
  EXPECT_EQ(problem_of("command: hover\n"),
            "study.yaml: flights: missing; expected a list of configuration files");
  EXPECT_EQ(problem_of("flights: [flights/none.yaml]\n"),
            "study.yaml:1:11: flights: flights/none.yaml: no such file");
  EXPECT_EQ(problem_of("flights: [flights/n*.yaml]\n"),
            "study.yaml:1:11: flights: flights/n*.yaml: matches no file");
  EXPECT_EQ(problem_of(flights + "seeds: [1, -2]\n"),
            "study.yaml:3:12: seeds: -2 is out of range, allowed: [0, 2147483647]");
  EXPECT_EQ(problem_of(flights + "estimators: flow\n"),
            "study.yaml: estimators: only with command: compare, not hover");
  EXPECT_NE(problem_of(flights + "configurations: {a/b: {}}\n").find("cannot name a folder"),
            std::string::npos);
  EXPECT_NE(problem_of(flights + "seeds: [1, 1]\n").find("two jobs have the ID calm-1"),
            std::string::npos);
}

TEST(Study, ReportsAWrongKeyOfAConfigurationAtItsLine) {
  const std::string problem = problem_of(
      "command: hover\nflights: [flights/calm.yaml]\nconfigurations:\n  a: {plant.wnd: 1}\n");
  EXPECT_TRUE(problem.starts_with("study.yaml:4:7: plant.wnd: unknown key, did you mean"))
      << problem;
  EXPECT_NE(problem_of("flights: [flights/video.yaml]\nseeds: [1]\n").find("seed: unknown key"),
            std::string::npos)
      << "a run has no seed";
}

TEST(JobRecord, IsValidForItsHashOnly) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "job.json";
  EXPECT_FALSE(read_job_record(file, "a"));
  write_job_record(file, {.hash = "a", .failure = "lost", .wall_s = 2});
  EXPECT_FALSE(read_job_record(file, "b"));
  EXPECT_EQ(read_job_record(file, "a")->failure, "lost");
  folder.write("job.json", R"({"schema_version": 1, "hash": )");
  EXPECT_FALSE(read_job_record(file, "a"));
}

json row(const std::string& id, const std::string& configuration, const json& value,
         const std::string& status = "finished") {
  return {{"id", id},           {"flight", id},
          {"flight_group", id}, {"estimator", ""},
          {"status", status},   {"configuration", configuration},
          {"results", ""},      {"seed", nullptr},
          {"wall_s", 1},        {"figures", {{"error", value}}}};
}

TEST(StudyStatistics, AreThoseOfAHandComputedCase) {
  std::vector<json> rows;
  for (const int value : {3, 9, 1, 7, 5, 11}) {
    rows.push_back(row(fmt::format("j{}", value), "a", value));
  }
  rows.push_back(row("lost", "a", nullptr));
  rows.push_back(row("broken", "a", nullptr, "failed"));
  rows.push_back(row("other", "b", 2));
  const json groups = study_groups(rows, {{.figure = "error"}});
  ASSERT_EQ(groups.size(), 2U);
  const json& found = groups[0]["figures"]["error"];
  EXPECT_EQ(groups[0]["jobs"], 8);
  EXPECT_EQ(groups[0]["failed"], 1);
  EXPECT_EQ(found["samples"], 6);
  EXPECT_EQ(found["median"], 6);
  EXPECT_EQ(found["low"], 1) << "six samples: the extremes, 97 %";
  EXPECT_EQ(found["high"], 11);
  EXPECT_EQ(found["nine_in_ten"], 11);
  EXPECT_EQ(found["worst_job"], "j11");
  EXPECT_EQ(groups[1]["figures"]["error"]["low"], nullptr) << "no interval of one sample";
  const json lowest = study_groups(rows, {{.figure = "error", .worst = WorstValue::lowest}});
  EXPECT_EQ(lowest[0]["figures"]["error"]["worst_job"], "j1");
  EXPECT_EQ(lowest[0]["figures"]["error"]["nine_in_ten"], 1);
}

// Two flights with two seeds each.
TEST(StudyStatistics, AreSeparateForFlightsOfSeveralJobs) {
  std::vector<json> rows;
  for (const int value : {1, 3, 10, 30}) {
    rows.push_back(row(fmt::format("j{}", value), "a", value));
    rows.back()["flight_group"] = value < 10 ? "calm" : "windy";
  }
  const json groups = study_groups(rows, {{.figure = "error"}});
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0]["flight_group"], "calm");
  EXPECT_EQ(groups[0]["figures"]["error"]["median"], 2);
  EXPECT_EQ(groups[1]["figures"]["error"]["median"], 20);
}

TEST(StudyResults, HaveTheWorstJobFirst) {
  const TemporaryFolder folder;
  const Study study =
      study_of(folder,
               "command: hover\nflights: [flights/calm.yaml]\nseeds: [1, 2, 3, 4, 5]\n"
               "metrics: [table.all.0]\n");
  const std::vector<Job> jobs = make_jobs(study, "");
  const auto finish = [&](std::size_t i, const std::string& summary) {
    const JobFiles files(folder.path(), jobs[i].id);
    folder.write(fmt::format("jobs/{}/summary.json", jobs[i].id), summary);
    write_job_record(files.record, {.hash = jobs[i].hash, .failure = std::nullopt});
  };
  finish(0, R"({"table": {"all": [0.5, 1]}, "scale": "none"})");
  finish(1, R"({"table": {"all": [0.75, 1]}})");
  finish(2, R"({"table": null})");
  write_job_record(JobFiles(folder.path(), jobs[3].id).record,
                   {.hash = jobs[3].hash, .failure = "crashed"});
  const json results = study_json(study, jobs, folder.path());
  Names order;
  for (const json& job : results["jobs"]) order.push_back(job["id"].get<std::string>());
  EXPECT_EQ(order, (Names{"calm-4", "calm-3", "calm-2", "calm-1", "calm-5"}));
  EXPECT_EQ(study_csv(results),
            "#id,flight,configuration,estimator,seed,status,wall_s,table.all.0,table.all.1\n"
            "calm-4,calm,,,4,failed,0.0,,\n"
            "calm-3,calm,,,3,finished,0.0,,\n"
            "calm-2,calm,,,2,finished,0.0,0.75,1\n"
            "calm-1,calm,,,1,finished,0.0,0.5,1\n"
            "calm-5,calm,,,5,pending,,,\n");
  EXPECT_TRUE(unknown_metrics(results).empty());
}

TEST(StudyResults, ReportAMisspeltMetric) {
  json study{{"metrics", {{{"figure", "eror"}}}}, {"jobs", {row("j", "a", 1)}}};
  EXPECT_EQ(unknown_metrics(study), Names{"metrics: no result has 'eror', did you mean 'error'?"});
}

}  // namespace
}  // namespace stillkite
