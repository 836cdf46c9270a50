#include "app/hover_comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

using nlohmann::json;

// A stabilized flight along x that stays `displacement_m` off all the time.
TrialRecord flight_off_by(double displacement_m, std::uint64_t seed) {
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

// Seeds differ far more than the estimators do, and the order of the flights differs too.
std::vector<ComparedTrials> paired_trials() {
  TrialRecord off = flight_off_by(9, 4);
  off.trial.stabilized = false;
  return {flown_by("a", {flight_off_by(0.1, 1), flight_off_by(0.3, 2), flight_off_by(0.8, 3), off}),
          flown_by("b", {flight_off_by(0.81, 3), flight_off_by(0.12, 1), flight_off_by(0.33, 2)})};
}

const json& difference_along(const json& comparison, const std::string& axis) {
  const json& list = comparison["differences"];
  return *std::find_if(list.begin(), list.end(), [&](const json& d) { return d["axis"] == axis; });
}

TEST(HoverComparison, pairs_the_seeds) {
  const json made = hover_comparison_json(paired_trials());
  const json& a = made["estimators"][0]["displacement"]["x"];
  EXPECT_EQ(a["trials"], 3) << "the flight without stabilization is none of its own";
  EXPECT_NEAR(a["mean_m"].get<double>(), 0.4, 1e-12);
  const json& difference = difference_along(made, "x");
  EXPECT_EQ(difference["of"], "b");
  EXPECT_EQ(difference["against"], "a");
  // 1, 2 and 3 cm: mean 2, deviation 1, t of two degrees of freedom 4.302653
  EXPECT_NEAR(difference["mean_m"].get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(difference["high_m"].get<double>(), 0.02 + 0.04302653 / std::sqrt(3.0), 1e-7);
  EXPECT_EQ(difference["verdict"], "not_significant");
}

TEST(HoverComparison, is_significant_where_every_seed_says_the_same) {
  auto trials = paired_trials();
  trials[1].records[0] = flight_off_by(0.82, 3);
  trials[1].records[2] = flight_off_by(0.321, 2);
  const json made = hover_comparison_json(trials);
  EXPECT_EQ(difference_along(made, "x")["verdict"], "worse");
  EXPECT_EQ(difference_along(made, "all")["verdict"], "worse");
  EXPECT_TRUE(difference_along(made, "y")["verdict"].is_null()) << "none was flown";
  const std::string table = hover_comparison_table(made);
  EXPECT_NE(table.find("40.00 +- "), std::string::npos) << table;
  EXPECT_NE(table.find(" worse\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace stillkite
