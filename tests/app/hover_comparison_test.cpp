#include "app/hover_comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

using nlohmann::json;

// Stabilized trial along x with constant displacement.
TrialRecord trial_at(double displacement_m, std::uint64_t seed) {
  TrialRecord record{.trial = {.axis = PaperAxis::x, .stabilized = true, .seed = seed},
                     .samples = {},
                     .kicks = {}};
  for (int i = 0; i < 3; ++i) {
    record.samples.push_back(
        {.t_s = 0.1 * i,
         .displacement_in_world_m = displacement_m * paper_axis_in_world(PaperAxis::x)});
  }
  return record;
}

ComparedTrials flown_by(const std::string& name, std::vector<TrialRecord> records) {
  return {.name = name,
          .overrides = {},
          .estimator = {},
          .records = std::move(records),
          .summary = {{"table", nullptr}, {"timing", nullptr}}};
}

// Differences between seeds exceed those between estimators; the order of the seeds differs.
std::vector<ComparedTrials> paired_trials() {
  TrialRecord off = trial_at(9, 4);
  off.trial.stabilized = false;
  return {flown_by("a", {trial_at(0.1, 1), trial_at(0.3, 2), trial_at(0.8, 3), off}),
          flown_by("b", {trial_at(0.81, 3), trial_at(0.12, 1), trial_at(0.33, 2)})};
}

const json& difference_along(const json& comparison, const std::string& axis) {
  const json& list = comparison["differences"];
  return *std::find_if(list.begin(), list.end(), [&](const json& d) { return d["axis"] == axis; });
}

TEST(HoverComparison, PairsTrialsBySeed) {
  const json comparison = hover_comparison_json(paired_trials());
  const json& a = comparison["estimators"][0]["displacement"]["x"];
  EXPECT_EQ(a["trials"], 3) << "trials without stabilization are excluded";
  EXPECT_NEAR(a["mean_m"].get<double>(), 0.4, 1e-12);
  const json& difference = difference_along(comparison, "x");
  EXPECT_EQ(difference["of"], "b");
  EXPECT_EQ(difference["against"], "a");
  // 1, 2 and 3 cm: mean 2, standard deviation 1; t(0.975, 2) = 4.302653
  EXPECT_NEAR(difference["mean_m"].get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(difference["high_m"].get<double>(), 0.02 + 0.04302653 / std::sqrt(3.0), 1e-7);
  EXPECT_EQ(difference["verdict"], "not_significant");
}

TEST(HoverComparison, IsSignificantForConsistentDifferences) {
  auto trials = paired_trials();
  trials[1].records[0] = trial_at(0.82, 3);
  trials[1].records[2] = trial_at(0.321, 2);
  const json comparison = hover_comparison_json(trials);
  EXPECT_EQ(difference_along(comparison, "x")["verdict"], "worse");
  EXPECT_EQ(difference_along(comparison, "all")["verdict"], "worse");
  EXPECT_TRUE(difference_along(comparison, "y")["verdict"].is_null()) << "no trial";
  const std::string table = hover_comparison_table(comparison);
  EXPECT_NE(table.find("40.00 +- "), std::string::npos) << table;
  EXPECT_NE(table.find(" worse\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace stillkite
