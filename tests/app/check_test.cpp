#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "app/command_line.hpp"
#include "app/setup_examination.hpp"
#include "geometry/gravity.hpp"
#include "io/video/frame_source.hpp"
#include "io/video/video_writer.hpp"
#include "tests/io/temporary_folder.hpp"

// Set-ups of simulated flights: ten with one error each, which `check` must name, and correct ones.

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::string>;

int command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "stillkite");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return run_command_line(static_cast<int>(argv.size()), argv.data(), "test");
}

// Flight of 14 s at 20 images per second over a ground, 480 x 360 px, with IMU and range finder.
void simulate(const fs::path& out, const Overrides& overrides) {
  std::vector<std::string> arguments{"simulate", "--out", out.string()};
  Overrides all{"seed=4",
                "camera.width_px=480",
                "camera.height_px=360",
                "camera.focal_x_px=360",
                "camera.focal_y_px=360",
                "camera.centre_x_px=239.5",
                "camera.centre_y_px=179.5",
                "camera.frames_per_s=20",
                "flight.duration_s=14",
                "flight.height_m=15",
                "flight.forward_m=30",
                "flight.left_m=5",
                "flight.climb_m=3",
                "flight.sway_m=1",
                "flight.tilt_sway_deg=4",
                "flight.yaw_sway_deg=8",
                "ground.side_texels=2048"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  for (const std::string& key : all) {
    arguments.emplace_back("--set");
    arguments.push_back(key);
  }
  ASSERT_EQ(command(arguments), 0);
}

using Row = std::vector<double>;

// Copy of a log with changed rows; the stamp is an integer.
fs::path rewrite(const fs::path& from, const fs::path& to,
                 const std::function<void(std::int64_t&, Row&)>& change) {
  std::ifstream in(from);
  std::ofstream out(to);
  out.precision(12);
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') {
      out << line << "\n";
      continue;
    }
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    std::int64_t stamp_ns = std::stoll(cell);
    Row row;
    while (std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
    change(stamp_ns, row);
    out << stamp_ns;
    for (const double value : row) out << "," << value;
    out << "\n";
  }
  return to;
}

// Questions with the verdict wrong, in order; the output is printed if a test fails.
std::string wrong_questions(const SetupReport& report) {
  std::string out;
  for (const SetupFinding& finding : report.findings) {
    if (finding.verdict == SetupVerdict::wrong) out += finding.question + ";";
  }
  return out;
}

std::string text_of(const SetupReport& report) {
  std::string out;
  for (const SetupFinding& finding : report.findings) {
    out += std::string(name_of(finding.verdict)) + "  " + finding.question + ": " + finding.text +
           " -> " + finding.remedy + "\n";
  }
  return out;
}

bool mentions(const SetupReport& report, const std::string& question, const std::string& text) {
  return std::ranges::any_of(report.findings, [&](const SetupFinding& finding) {
    return finding.question == question &&
           (finding.text + finding.remedy).find(text) != std::string::npos;
  });
}

class Check : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TemporaryFolder;
    simulate(nadir(), {});
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }

  static fs::path nadir() { return folder->path() / "nadir"; }
  static fs::path imu_log() { return nadir() / "imu0" / "data.csv"; }

  static SetupReport examine(Overrides overrides, const fs::path& flight = nadir()) {
    return examine_setup(load_run_config(flight / "run.yaml", overrides));
  }

  static SetupReport with_imu(const std::function<void(std::int64_t&, Row&)>& change,
                              Overrides overrides = {}) {
    const fs::path log = rewrite(imu_log(), folder->path() / "imu.csv", change);
    overrides.push_back("imu.path=" + log.string());
    return examine(overrides);
  }

  static TemporaryFolder* folder;
};
TemporaryFolder* Check::folder = nullptr;

TEST_F(Check, CorrectFlightIsOk) {
  const SetupReport report = with_imu([](std::int64_t&, Row&) {});
  EXPECT_EQ(worst_verdict(report.findings), SetupVerdict::ok) << text_of(report);
  for (const char* question :
       {"resolution", "lens", "imu axes", "imu clock", "imu rates", "mount", "size of gravity",
        "direction of gravity", "initial height", "focal length", "policy"}) {
    const auto found = std::ranges::find(report.findings, question, &SetupFinding::question);
    ASSERT_NE(found, report.findings.end()) << question;
    EXPECT_EQ(found->verdict, SetupVerdict::ok) << question << ": " << found->text;
  }
  const SetupReport without_imu = examine({});
  EXPECT_EQ(worst_verdict(without_imu.findings), SetupVerdict::ok) << text_of(without_imu);
}

TEST_F(Check, NamesWrongAxesOfTheImu) {
  // sensor x down, y right, z backward
  const SetupReport report = with_imu([](std::int64_t&, Row& row) {
    row = {-row[2], -row[1], -row[0], -row[5], -row[4], -row[3]};
  });
  EXPECT_EQ(wrong_questions(report), "imu axes;") << text_of(report);
  EXPECT_TRUE(
      mentions(report, "imu axes", "imu: {rotation_wxyz: [0.0000, 0.7071, 0.0000, -0.7071]}"))
      << text_of(report);
  // the remedy is right
  const fs::path log = folder->path() / "imu.csv";
  const SetupReport corrected =
      examine({"imu.path=" + log.string(), "imu.rotation_wxyz=[0, 0.7071068, 0, -0.7071068]"});
  EXPECT_EQ(worst_verdict(corrected.findings), SetupVerdict::ok) << text_of(corrected);
}

TEST_F(Check, NamesAClockOffset) {
  const SetupReport report =
      with_imu([](std::int64_t& stamp_ns, Row&) { stamp_ns += 120'000'000; });
  EXPECT_EQ(wrong_questions(report), "imu clock;") << text_of(report);
  EXPECT_TRUE(mentions(report, "imu clock", "imu: {time_offset_s: -0.1")) << text_of(report);
}

TEST_F(Check, NamesALensOfAnotherResolution) {
  const SetupReport report = examine(
      {"calibration.path=null",
       "calibration.camera={width_px: 960, height_px: 720, focal_x_px: 720, focal_y_px: 720, "
       "centre_x_px: 479.5, centre_y_px: 359.5}"});
  EXPECT_EQ(wrong_questions(report), "resolution;") << text_of(report);
  EXPECT_TRUE(mentions(report, "resolution", "focal_x_px: 360")) << text_of(report);
}

TEST_F(Check, NamesMirroredImages) {
  const fs::path mirrored = folder->path() / "mirrored.mp4";
  FrameSource source({.path = nadir() / "flight.mp4"});
  VideoWriter writer(mirrored, source.first().grey.size(), 20, {.crf = 18});
  while (const auto frame = source.next()) {
    cv::Mat image;
    cv::flip(frame->grey, image, 1);
    writer.write(image);
  }
  writer.finish();
  writer.commit();
  const SetupReport report =
      with_imu([](std::int64_t&, Row&) {}, {"source.path=" + mirrored.string()});
  EXPECT_EQ(wrong_questions(report), "mirrored images;") << text_of(report);
}

TEST_F(Check, NamesAMount) {
  const SetupReport report = with_imu([](std::int64_t&, Row&) {}, {"mount.down_deg=40"});
  EXPECT_EQ(wrong_questions(report), "mount;") << text_of(report);
}

TEST_F(Check, NamesFeet) {
  const fs::path log = rewrite(nadir() / "range.csv", folder->path() / "feet.csv",
                               [](std::int64_t&, Row& row) { row[0] /= 0.3048; });
  const SetupReport report =
      with_imu([](std::int64_t&, Row&) {},
               {"height.source=range", "height.path=" + log.string(), "initial.from_truth=false"});
  EXPECT_EQ(wrong_questions(report), "initial height;") << text_of(report);
  EXPECT_TRUE(mentions(report, "initial height", "feet instead of metres")) << text_of(report);
  // a speed instead of an IMU
  const SetupReport by_speed =
      examine({"height.source=range", "height.path=" + log.string(), "initial.from_truth=false"});
  EXPECT_TRUE(mentions(by_speed, "initial height", "feet instead of metres")) << text_of(by_speed);
}

TEST_F(Check, NamesForcesInG) {
  const SetupReport report = with_imu([](std::int64_t&, Row& row) {
    for (std::size_t i = 3; i < 6; ++i) row[i] /= kGravity_m_s2;
  });
  EXPECT_EQ(wrong_questions(report), "size of gravity;") << text_of(report);
  EXPECT_TRUE(mentions(report, "size of gravity", "the unit is g")) << text_of(report);
}

TEST_F(Check, NamesDegrees) {
  const SetupReport report = with_imu([](std::int64_t&, Row& row) {
    for (std::size_t i = 0; i < 3; ++i) row[i] *= 180 / M_PI;
  });
  EXPECT_EQ(wrong_questions(report), "imu rates;") << text_of(report);
  EXPECT_TRUE(mentions(report, "imu rates", "deg/s instead of rad/s")) << text_of(report);
}

TEST_F(Check, NamesSwappedColumns) {
  const SetupReport forces_first = with_imu(
      [](std::int64_t&, Row& row) { row = {row[3], row[4], row[5], row[0], row[1], row[2]}; });
  EXPECT_EQ(wrong_questions(forces_first), "imu columns;") << text_of(forces_first);
  const SetupReport y_first = with_imu(
      [](std::int64_t&, Row& row) { row = {row[1], row[0], row[2], row[4], row[3], row[5]}; });
  EXPECT_EQ(wrong_questions(y_first), "imu axes;") << text_of(y_first);
  EXPECT_TRUE(mentions(y_first, "imu axes", "x = y, y = x, z = z")) << text_of(y_first);
}

TEST_F(Check, NamesGpsTime) {
  const SetupReport report =
      with_imu([](std::int64_t& stamp_ns, Row&) { stamp_ns += 1'400'000'000'000'000'000; });
  EXPECT_EQ(wrong_questions(report), "imu clock;") << text_of(report);
  EXPECT_TRUE(mentions(report, "imu clock", "absolute time")) << text_of(report);
}

// Flights without an error: other mounts, speeds, scenes, lenses and clocks.
TEST_F(Check, AccusesNoCorrectFlight) {
  struct Case {
    const char* name;
    Overrides simulation, run;
  };
  const std::vector<Case> cases{
      {"oblique", {"camera.forward_tilt_deg=45", "seed=21"}, {}},
      {"lens",
       {"camera.distortion=radial-tangential",
        "camera.coefficients=[-0.28, 0.07, 0.001, -0.002, 0, 0, 0, 0]", "seed=22"},
       {}},
      {"hover", {"flight.forward_m=0", "flight.left_m=0", "flight.climb_m=0", "seed=23"}, {}},
      {"fast", {"flight.height_m=60", "flight.forward_m=200", "seed=24"}, {}},
      {"bias", {"imu.gyro_bias_rad_s=0.05", "camera.readout_s=0.01", "seed=25"}, {}},
      {"room",
       {"scene=room", "flight.shape=hand", "flight.height_m=1.5", "flight.sway_m=0.1", "seed=26"},
       {}}};
  for (const Case& c : cases) {
    const fs::path flight = folder->path() / c.name;
    simulate(flight, c.simulation);
    Overrides run = c.run;
    run.push_back("imu.path=" + (flight / "imu0" / "data.csv").string());
    const SetupReport report = examine(run, flight);
    EXPECT_EQ(worst_verdict(report.findings), SetupVerdict::ok) << c.name << "\n"
                                                                << text_of(report);
  }
}

}  // namespace
}  // namespace stillkite
