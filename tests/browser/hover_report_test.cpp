#include "io/report/hover_report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "io/report/base64.hpp"
#include "io/report/hover_distribution.hpp"
#include "tests/browser/synthetic_trials.hpp"

namespace stillkite {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

HoverReportTrial trial_at(int moved_axis, bool stabilized,
                          const std::vector<Eigen::Vector3d>& displacements_m) {
  HoverReportTrial trial{.moved_axis = moved_axis, .stabilized = stabilized};
  for (const Eigen::Vector3d& displacement_m : displacements_m) {
    trial.samples.push_back({.displacement_m = displacement_m});
  }
  return trial;
}

std::size_t page_size(const SyntheticTrials& trials) {
  return hover_report_html(trials.content("trials"), synthetic_hover_summary(trials)).size();
}

TEST(DisplacementHistogram, CountsMovedAxisInCellsCentredAtZero) {
  const std::vector<HoverReportTrial> trials{
      trial_at(0, true, {{0, 9, 9}, {0.024, 9, 9}, {-0.024, 9, 9}, {0.026, 9, 9}, {-0.12, 9, 9}}),
      trial_at(0, true, {{0.01, 0, 0}}), trial_at(0, false, {{1, 0, 0}, {kNaN, 0, 0}}),
      trial_at(2, true, {{1, 0, 0}})};
  const CellCounts counts = displacement_histogram(trials, 0);
  EXPECT_EQ(counts.size_m, 0.05);
  EXPECT_EQ(counts.on, (std::map<int, int>{{-2, 1}, {0, 4}, {1, 1}}));
  EXPECT_EQ(counts.off, (std::map<int, int>{{20, 1}}));
}

TEST(DisplacementHistogram, EnlargesCellsSoThatSixtyCoverTheMaximum) {
  const auto size_m = [](double d_m) {
    const std::vector<HoverReportTrial> trials{trial_at(1, false, {{0, -d_m, 0}})};
    return displacement_histogram(trials, 1).size_m;
  };
  EXPECT_DOUBLE_EQ(size_m(2.9), 0.05);
  EXPECT_DOUBLE_EQ(size_m(3.1), 0.1);
  EXPECT_DOUBLE_EQ(size_m(7), 0.2);
  EXPECT_DOUBLE_EQ(size_m(29), 0.5);
  EXPECT_GE(60 * size_m(1e30), 1e30);
  EXPECT_EQ(size_m(std::numeric_limits<double>::infinity()), 0.05);
}

// Hold paper, Fig. 3: x-y for the sets along x and y, z-y for the set along z.
TEST(DisplacementHeat, UsesVerticalPlaneOfTheMovedAxis) {
  const Eigen::Vector3d d_m(0.1, 0.2, 0.3);
  for (const int axis : {0, 1, 2}) {
    const std::vector<HoverReportTrial> trials{trial_at(axis, true, {d_m, d_m})};
    const PlaneCounts counts = displacement_heat(trials, axis);
    const std::array<int, 2> cell{axis == 2 ? 6 : 2, 4};
    EXPECT_EQ(counts.on, (std::map<std::array<int, 2>, int>{{cell, 2}}));
    EXPECT_TRUE(counts.off.empty());
  }
}

TEST(HoverReport, IsSmallerThan3MB) {
  SyntheticTrials trials = synthetic_trials();
  EXPECT_LT(page_size(trials), 3'000'000U);
  // 5 times as many trials, 3 times as long, each with large images
  for (HoverReportTrial& trial : trials.trials) {
    const std::vector<HoverReportSample> samples = trial.samples;
    for (int i = 0; i < 2; ++i) {
      trial.samples.insert(trial.samples.end(), samples.begin(), samples.end());
    }
    trial.images.assign(100, {0, std::vector<std::uint8_t>(20'000)});
  }
  const std::vector<HoverReportTrial> once = trials.trials;
  for (int i = 0; i < 4; ++i) {
    trials.trials.insert(trials.trials.end(), once.begin(), once.end());
  }
  EXPECT_LT(page_size(trials), 3'000'000U);
}

TEST(HoverReport, ConvertsWorldToPaperAxes) {
  std::vector<HoverReportTrial> trials{trial_at(0, true, {{0, 0, 0}})};
  trials[0].samples[0].drone_in_world_m = {1, 2, 3};
  const std::string html = hover_report_html({.title = "", .trials = trials}, {});
  const auto column = [](const std::string& name, float value) {
    return "\"drone_" + name + "\":\"" + base64(std::array{value}) + "\"";
  };
  EXPECT_NE(html.find(column("x", 1)), std::string::npos);
  EXPECT_NE(html.find(column("y", 3)), std::string::npos);
  EXPECT_NE(html.find(column("z", -2)), std::string::npos);
}

TEST(HoverReport, IsSelfContained) {
  const SyntheticTrials trials = synthetic_trials();
  const std::string html =
      hover_report_html(trials.content("trials"), synthetic_hover_summary(trials));
  for (const char* loader : {"<script src", " src=", "<link", "@import", "url("}) {
    EXPECT_EQ(html.find(loader), std::string::npos) << loader;
  }
}

TEST(HoverReport, RejectsInvalidAxis) {
  const std::vector<HoverReportTrial> trials{trial_at(0, true, {}), {.moved_axis = 3}};
  EXPECT_THROW(static_cast<void>(hover_report_html({.title = "", .trials = trials}, {})),
               std::out_of_range);
}

}  // namespace
}  // namespace stillkite
