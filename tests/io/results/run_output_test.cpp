#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/dataset/table_reader.hpp"
#include "io/dataset/trajectory_file.hpp"
#include "io/results/command_recorder.hpp"
#include "io/results/estimates_csv.hpp"
#include "io/results/run_recorder.hpp"
#include "io/results/run_summary.hpp"
#include "io/text_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

NavigationEstimate sample(int i) {
  NavigationEstimate e;
  e.stamp = {1403715273262142976 + i * 40000000LL};
  e.frame_index = i;
  e.verdict = i == 0 ? Verdict::first_frame : i == 3 ? Verdict::frozen : Verdict::ok;
  e.world_from_body = {so3_exp({0.01 * i, 0.02, 0.3}), {1.0 * i, -2.0, 100.0 / 3.0}};
  e.twist_in_camera = {{1, 2, 3}, {4, 5, 6}};
  if (i == 1) e.measured_twist = Twist{{7, 8, 9}, {10, 11, 12}};
  e.pose_covariance.diagonal() << 1, 4, 9, 16, 25, 36;
  e.scale = ScaleSource::range;
  e.scale_age_s = 0.25;
  e.stage_ms = {1, 2, 3, 4};
  return e;
}

TEST(RunOutput, EstimatesAndTrajectoryReadBack) {
  const TemporaryFolder folder;
  {
    RunRecorder recorder(folder.path());
    for (int i = 0; i < 100; ++i) recorder.add(sample(i));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "estimates.csv"));
    recorder.commit();
  }
  const auto poses = read_trajectory(folder.path());
  ASSERT_EQ(poses.size(), 100u);
  EXPECT_EQ(poses[7].stamp, sample(7).stamp);
  EXPECT_EQ(poses[7].world_from_body.translation, sample(7).world_from_body.translation);

  TableReader table(folder.path() / "estimates.csv", Separator::comma, 50);
  for (int i = 0; i < 100; ++i) {
    const NavigationEstimate e = sample(i);
    ASSERT_TRUE(table.next());
    EXPECT_EQ(table.stamp(), e.stamp);
    EXPECT_EQ(table.number(1), i);
    EXPECT_EQ(table.text(2), name_of(e.verdict));
    EXPECT_NEAR(table.number(5), e.world_from_body.translation.z(), 1e-6);
    EXPECT_NEAR(table.number(6), e.world_from_body.rotation.w(), 1e-8);
    EXPECT_EQ(table.number(21), 6);  // wz_camera
    if (e.measured_twist) {
      EXPECT_EQ(table.number(22), 7);
    } else {
      EXPECT_EQ(table.text(22), "");
    }
    EXPECT_EQ(table.number(33), 6);  // sd_rz_world
    EXPECT_EQ(table.text(40), "range");
  }
  EXPECT_FALSE(table.next());
}

TEST(RunOutput, HeaderNamesEveryColumn) {
  const std::string header = estimates_csv_header();
  const std::string row = estimates_csv_row(sample(1));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_TRUE(header.ends_with("pyramid [ms],flow [ms],solve [ms],filter [ms]\n"));
  EXPECT_TRUE(row.ends_with(",1,2,3,4\n"));
}

std::string cell(const NavigationEstimate& estimate, std::string_view column) {
  const std::string header = estimates_csv_header();
  const std::string row = estimates_csv_row(estimate);
  std::istringstream names(header), cells(row);
  std::string name, text;
  while (std::getline(names, name, ',') && std::getline(cells, text, ',')) {
    if (name == column) return text;
  }
  ADD_FAILURE() << "no column " << column;
  return {};
}

TEST(RunOutput, LengthsWithoutScaleAreInHeights) {
  NavigationEstimate estimate = sample(1);
  for (const char* column : {"x_in_heights []", "sd_vx_camera_in_heights [1/s]"}) {
    EXPECT_EQ(cell(estimate, column), "") << column;
  }
  EXPECT_EQ(cell(estimate, "y [m]"), "-2");
  estimate.scale = ScaleSource::none;
  for (const char* column : {"y [m]", "vx_world [m/s]", "vz_camera [m/s]", "sd_z [m]",
                             "sd_vy_camera [m/s]", "measured_vx_camera [m/s]"}) {
    EXPECT_EQ(cell(estimate, column), "") << column;
  }
  EXPECT_EQ(cell(estimate, "wz_camera [rad/s]"), "6");
  EXPECT_EQ(cell(estimate, "sd_rz_world [rad]"), "6");
  EXPECT_EQ(cell(estimate, "y_in_heights []"), "-2");
  EXPECT_EQ(cell(estimate, "vz_camera_in_heights [1/s]"), "3");
  RunTally tally;
  tally.add(estimate);
  const nlohmann::json summary = run_summary(tally, {.frames_read = 1, .wall_s = 1}, nullptr);
  EXPECT_TRUE(summary["final"]["position_m"].is_null());
  EXPECT_EQ(summary["final"]["position_in_heights"][1], -2);
  estimate.source = EstimateSource::reference;
  EXPECT_EQ(cell(estimate, "y_in_heights []"), "");
}

TEST(RunOutput, SummaryCountsFramesAndHasNoNaN) {
  RunTally tally;
  for (int i = 0; i < 5; ++i) {
    NavigationEstimate estimate = sample(i);
    if (i == 4) {
      estimate.world_from_body.translation.x() = std::numeric_limits<double>::quiet_NaN();
    }
    tally.add(estimate);
  }
  const std::vector<float> frame_ms{5, 1, 4, 2, 3};
  const nlohmann::json summary =
      run_summary(tally, {.frames_read = 7, .frame_ms = frame_ms, .wall_s = 0.5}, nullptr);
  EXPECT_EQ(summary["frames"], (nlohmann::json{{"read", 7}, {"used", 4}, {"rejected", 3}}));
  EXPECT_DOUBLE_EQ(summary["availability_ratio"], 4.0 / 7);
  EXPECT_EQ(summary["verdicts"]["ok"], 3);
  EXPECT_EQ(summary["verdicts"]["frozen"], 1);
  EXPECT_EQ(summary["verdicts"]["horizon"], 0);
  EXPECT_EQ(summary["timing"]["frame_ms"]["median"], 3);
  EXPECT_EQ(summary["timing"]["frame_ms"]["p99"], 5);
  EXPECT_EQ(summary["timing"]["frames_per_s"], 10);
  EXPECT_EQ(summary["timing"]["stages_ms"]["solve"], 3);
  EXPECT_EQ(summary["scale"]["source"], "range");
  EXPECT_EQ(summary["scale"]["age_s"], 0.25);
  EXPECT_TRUE(summary["final"]["position_m"][0].is_null());
  EXPECT_TRUE(summary["evaluation"].is_null());
  EXPECT_GT(summary["memory"]["peak_rss_mib"].get<double>(), 1);
  EXPECT_EQ(summary.dump().find("nan"), std::string::npos);
}

TEST(RunOutput, DISABLED_PrintsPeakMemory) {
  fmt::print("peak {:.1f} MiB\n", peak_rss_mib());
}

// A process that holds 300 MiB starts this program again.
TEST(RunOutput, PeakMemoryIsThatOfThisProcessAlone) {
  const std::vector<char> held(300 << 20, 'x');
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = program +
                              " --gtest_also_run_disabled_tests "
                              "--gtest_filter=RunOutput.DISABLED_PrintsPeakMemory";
  FILE* const output = popen(command.c_str(), "r");
  ASSERT_NE(output, nullptr);
  double peak_mib = 0;
  for (std::array<char, 256> line{}; std::fgets(line.data(), line.size(), output) != nullptr;) {
    if (std::string_view(line.data()).starts_with("peak ")) peak_mib = std::atof(&line[5]);
  }
  EXPECT_EQ(pclose(output), 0);
  EXPECT_GT(peak_mib, 1);
  EXPECT_LT(peak_mib, 0.5 * static_cast<double>(held.size() >> 20));
}

TEST(RunOutput, CommandsAreCountedAndReadBack) {
  const TemporaryFolder folder;
  CommandRecorder recorder(folder.path());
  const HoldDecision command{.command = {0.1, -0.2, 0.3, -0.4},
                             .action = HoldAction::command,
                             .reason = HoldReason::none,
                             .position_error_in_station_m = {1, -2, 3},
                             .yaw_error_rad = 0.5};
  recorder.add({1000}, {});
  recorder.add({2000}, command);
  recorder.add({3000}, command);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "commands.csv"));
  recorder.commit();
  EXPECT_EQ(recorder.counts().issued, 2);
  EXPECT_EQ(recorder.counts().held, 1);

  TableReader table(folder.path() / "commands.csv", Separator::comma, 11);
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.text(1), "hold");
  EXPECT_EQ(table.text(2), "no_estimate");
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.stamp(), Timestamp{2000});
  EXPECT_EQ(table.text(1), "command");
  const std::array expected{0.1, -0.2, 0.3, -0.4, 1.0, -2.0, 3.0, 0.5};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(table.number(static_cast<int>(i) + 3), expected[i]) << i;
  }

  const nlohmann::json with = run_summary({}, {.commands = recorder.counts()}, nullptr);
  EXPECT_EQ(with["commands"], (nlohmann::json{{"issued", 2}, {"held", 1}}));
  EXPECT_TRUE(run_summary({}, {}, nullptr)["commands"].is_null());
}

TEST(RunOutput, SummaryOfNoFramesIsNull) {
  const nlohmann::json summary = run_summary({}, {.wall_s = 0}, nullptr);
  EXPECT_TRUE(summary["final"].is_null());
  EXPECT_TRUE(summary["timing"]["frame_ms"]["median"].is_null());
  EXPECT_TRUE(summary["timing"]["frames_per_s"].is_null());
}

}  // namespace
}  // namespace stillkite
