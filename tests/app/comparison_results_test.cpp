#include "app/comparison_results.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stillkite {
namespace {

using nlohmann::json;

constexpr int kComparedFrames = 200;

// Position errors of `mean_m` with 1 cm noise; linearly drifting attitude errors.
ComparedRun synthetic_run(const std::string& name, double mean_m, double drift_rad) {
  ComparedRun run{.name = name, .overrides = {}, .estimator = {}, .summary = {}, .errors = {}};
  std::mt19937_64 random(static_cast<unsigned char>(name[0]));
  std::normal_distribution<double> noise_m(mean_m, 0.01);
  for (int i = 0; i < kComparedFrames; ++i) {
    FrameError error{};
    error[static_cast<std::size_t>(FrameFigure::position)] = noise_m(random);
    error[static_cast<std::size_t>(FrameFigure::attitude)] = drift_rad * i;
    run.errors.push_back(error);
  }
  run.summary = {{"frames", {{"read", kComparedFrames}, {"used", 150}, {"rejected", 50}}},
                 {"verdicts", {{"ok", 149}, {"first_frame", 1}, {"lost", 50}, {"frozen", 0}}},
                 {"timing", {{"frame_ms", {{"median", 4.0}, {"p99", 6.0}}}}},
                 {"memory", {{"peak_rss_mib", 100}}},
                 {"evaluation",
                  {{"position_rmse_m", mean_m},
                   {"velocity_rmse_m_s", {0, 3, 4}},
                   {"reference", {{"direction_median_deg", 3}, {"directions", 149}}}}}};
  run.estimator_s = 0.8;
  return run;
}

json comparison_of(const std::vector<ComparedRun>& runs) {
  return comparison_json(runs, {.frames_read = kComparedFrames, .wall_s = 2, .decoding_s = 0.5});
}

TEST(ComparisonJson, HasDocumentedKeys) {
  const json comparison =
      comparison_of({synthetic_run("flow", 0.1, 0), synthetic_run("own", 0.2, 0)});
  const json& entry = comparison["estimators"][1];
  EXPECT_EQ(entry["name"], "own");
  EXPECT_EQ(entry["policy"], "flow");
  EXPECT_EQ(entry["availability_ratio"], 0.75);
  EXPECT_EQ(entry["timing"]["frame_ms"]["p99"], 6.0);
  EXPECT_EQ(entry["evaluation"]["position_rmse_m"], 0.2);
  EXPECT_NEAR(entry["mean_error"]["position_m"].get<double>(), 0.2, 3e-3);
  EXPECT_TRUE(entry["mean_error"]["velocity_m_s"].is_null());
  EXPECT_EQ(comparison["timing"]["estimators_s"]["flow"], 0.8);
  EXPECT_EQ(comparison["timing"]["threads"], 1);
}

TEST(ComparisonJson, ReportsVerdictForEveryPair) {
  const json comparison = comparison_of(
      {synthetic_run("a", 0.1, 0), synthetic_run("b", 0.2, 1e-3), synthetic_run("c", 0.1, 0)});
  const auto verdict = [&](const char* of, const char* against, const char* figure) {
    for (const json& d : comparison["differences"]) {
      if (d["of"] == of && d["against"] == against && d["figure"] == figure) return d["verdict"];
    }
    return json();
  };
  EXPECT_EQ(comparison["differences"].size(), 6U) << "three pairs x position and attitude";
  EXPECT_EQ(verdict("b", "a", "position_m"), "worse");
  EXPECT_EQ(verdict("c", "b", "position_m"), "better");
  EXPECT_EQ(verdict("c", "a", "position_m"), "not_significant");
  EXPECT_EQ(verdict("b", "a", "attitude_rad"), "drifting");
}

TEST(ComparisonTable, ShowsFiguresMarksAndTimes) {
  const std::string table = comparison_table(
      comparison_of({synthetic_run("flow", 0.1, 0), synthetic_run("own", 0.2, 1e-3)}));
  EXPECT_NE(table.find("position RMSE, m                             0.1                  0.2\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("5                    5\n"), std::string::npos) << "|(0, 3, 4)| is 5";
  EXPECT_NE(table.find("directions               149                  149\n"), std::string::npos)
      << "medians over different frames are not comparable";
  EXPECT_NE(table.find(" worse\n"), std::string::npos);
  EXPECT_NE(table.find(" drifting\n"), std::string::npos);
  EXPECT_NE(table.find("frames lost"), std::string::npos);
  EXPECT_EQ(table.find("frames frozen"), std::string::npos) << "did not occur";
  EXPECT_NE(table.find("one thread per estimator"), std::string::npos);
}

TEST(ComparisonTable, HasNoMarksWithoutTruth) {
  std::vector<ComparedRun> runs{synthetic_run("flow", 0.1, 0), synthetic_run("own", 0.2, 0)};
  for (ComparedRun& run : runs) {
    run.errors.clear();
    run.summary["evaluation"] = nullptr;
  }
  const std::string table = comparison_table(comparison_of(runs));
  EXPECT_EQ(table.find("RMSE"), std::string::npos);
  EXPECT_EQ(table.find("significant"), std::string::npos);
  EXPECT_NE(table.find("availability, %"), std::string::npos);
}

}  // namespace
}  // namespace stillkite
