#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "live/link/line_splitter.hpp"
#include "live/tether/command_lines.hpp"
#include "live/tether/station_lines.hpp"

namespace stillkite {
namespace {

std::vector<std::string> lines_of(LineSplitter& splitter, std::string_view bytes) {
  splitter.add(bytes);
  std::vector<std::string> out;
  while (auto line = splitter.next()) out.push_back(*line);
  return out;
}

TEST(StationLines, MessagesAreRestoredFromTheirLines) {
  const auto restored = [](const StationMessage& message) {
    LineSplitter splitter;
    return parse_station_line(lines_of(splitter, station_line(message)).at(0)).value();
  };
  const auto status = std::get<StationStatus>(restored(StationStatus{1, 12.5, 14.25, -702.25}));
  EXPECT_EQ(status.mode, 1);
  EXPECT_EQ(status.runtime_s, 12.5);
  EXPECT_EQ(status.battery, 14.25);
  EXPECT_EQ(status.relative_length_counts, -702.25);
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  const auto attitude = std::get<DroneAttitude>(restored(DroneAttitude{q}));
  EXPECT_LT(attitude.world_from_body.angularDistance(q), 1e-5);
  const auto position = std::get<DronePosition>(restored(DronePosition{-0.25, 4.5, 1.125}));
  EXPECT_EQ(position.elevation_from_zenith_rad, -0.25);
  EXPECT_EQ(position.azimuth_rad, 4.5);
  EXPECT_EQ(position.barometer_m, 1.125);
  const auto drone = std::get<DroneStatus>(restored(DroneStatus{2, 60, 3.5, 0x1001}));
  EXPECT_EQ(drone.mode, 2);
  EXPECT_EQ(drone.fault_flags, 0x1001U);
}

TEST(StationLines, SeparatorsMayBeCommasOrBlanks) {
  for (const char* line : {"!Pos 0.5,-1,2", "!Pos 0.5 -1 2", "  !Pos, 0.5, -1,\t2 "}) {
    const auto message = parse_station_line(line);
    ASSERT_TRUE(message) << line;
    EXPECT_EQ(std::get<DronePosition>(*message).azimuth_rad, -1);
  }
}

TEST(StationLines, DamagedLinesAreIgnored) {
  for (const char* line : {"",
                           "!",
                           "Pos 1,2,3",
                           "!Pos",
                           "!Pos 1,2",
                           "!Pos 1,2,3,4",
                           "!Pos 1,2,x",
                           "!Pos nan,0,0",
                           "!Pos 4,0,0",
                           "!Pos 1,inf,0",
                           "!Posi 1,2,3",
                           "!Pos 1,2,3!GSStatus 1,2,3,4",
                           "!Attitude 0.5,0,0,0",
                           "!Attitude 0,0,0,0",
                           "!GSStatus 1.5,0,0,0",
                           "!GSStatus -1,0,0,0",
                           "!GSStatus 1,0,0,1e9",
                           "!FlightStatus 2,0,0,8192",
                           "!FlightStatus flying,0,0,0",
                           "!Gimbal 1,0,0,0"}) {
    EXPECT_FALSE(parse_station_line(line)) << line;
  }
}

TEST(StationLines, LinesAreFoundInAnyChunksAndAmongGarbage) {
  LineSplitter splitter;
  EXPECT_TRUE(lines_of(splitter, "!Pos 1,").empty());
  EXPECT_EQ(lines_of(splitter, "2,3\r\n\r\n!Yaw\r!Pos"),
            (std::vector<std::string>{"!Pos 1,2,3", "!Yaw"}));
  EXPECT_EQ(lines_of(splitter, "\n").at(0), "!Pos");
  // an endless line does not fill the memory, and its end is no line
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(lines_of(splitter, std::string(100, 'x')).empty());
  EXPECT_EQ(lines_of(splitter, "!Pos 1,2,3\n!Pos 4,5,6\n"),
            (std::vector<std::string>{"!Pos 4,5,6"}));
}

// Below the dead zone d the mean of the pulses is v; the position error is at most d dt / 2.
TEST(DeadZoneStepper, PulsesHaveTheMeanOfTheVelocity) {
  constexpr double kDeadZone = 5, kPeriod_s = 1 / 32.0;
  for (const double velocity : {0.3, 1.0, 2.4, 2.6, 4.9, -1.7}) {
    DeadZoneStepper stepper(kDeadZone);
    double position = 0;
    for (int i = 0; i < 3200; ++i) {
      const double sent = stepper.step(velocity, kPeriod_s);
      EXPECT_TRUE(sent == 0 || sent == std::copysign(kDeadZone, velocity)) << sent;
      position += sent * kPeriod_s;
      const double error = position - velocity * (i + 1) * kPeriod_s;
      ASSERT_LE(std::abs(error), kDeadZone * kPeriod_s / 2 + 1e-9);
    }
  }
}

TEST(DeadZoneStepper, PassesLargerVelocitiesAndStopsAtOnce) {
  DeadZoneStepper stepper(5);
  EXPECT_EQ(stepper.step(5, 0.03), 5);
  EXPECT_EQ(stepper.step(-7.5, 0.03), -7.5);
  EXPECT_EQ(stepper.step(3, 0.03), 5);
  EXPECT_EQ(stepper.step(0, 0.03), 0);
  // no rest of the pulse before
  EXPECT_EQ(stepper.step(1, 0.03), 0);
  EXPECT_EQ(DeadZoneStepper(0).step(0.01, 0.03), 0.01);
}

// elevation above the horizontal grows, that of !Pos falls
TEST(CommandLines, RatesAreLimitedAndInTheStationsUnits) {
  CommandLines lines(TetherConfig{});
  EXPECT_EQ(lines.lines({.length_rate_m_s = 0.0285,
                         .elevation_rate_rad_s = 0.1,
                         .azimuth_rate_rad_s = -0.05,
                         .yaw_rate_rad_s = 0.3},
                        {0}),
            "Pos2 -0.1000,-0.0500,10.00\nYaw 0.3000\n");
  EXPECT_EQ(lines.lines({.length_rate_m_s = -100,
                         .elevation_rate_rad_s = -9,
                         .azimuth_rate_rad_s = 9,
                         .yaw_rate_rad_s = -9},
                        {0}),
            "Pos2 0.2500,0.2000,-10000.00\nYaw -0.4000\n");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(lines.lines({nan, nan, std::numeric_limits<double>::infinity(), nan}, {0}),
            "Pos2 0.0000,0.0000,0.00\nYaw 0.0000\n");
  EXPECT_EQ(lines.lines({}, {0}), "Pos2 0.0000,0.0000,0.00\nYaw 0.0000\n");
}

TEST(CommandLines, InversionChangesEachSign) {
  const TetherCommand command{.length_rate_m_s = 0.285,
                              .elevation_rate_rad_s = 0.1,
                              .azimuth_rate_rad_s = 0.05,
                              .yaw_rate_rad_s = 0.3};
  CommandLines lines({.invert_elevation = true, .invert_azimuth = true, .invert_yaw = true});
  EXPECT_EQ(lines.lines(command, {0}), "Pos2 0.1000,-0.0500,100.00\nYaw -0.3000\n");
  CommandLines json({.format = TetherFormat::json});
  EXPECT_EQ(json.lines(command, {0}),
            "{\"schema\":1,\"length_rate\":0.28500,\"elevation_rate\":0.10000,"
            "\"azimuth_rate\":0.05000,\"yaw_rate\":0.30000}\n");
}

TEST(CommandLines, StationReadsWhatIsSent) {
  CommandLines lines(TetherConfig{});
  LineSplitter splitter;
  const auto sent = lines_of(splitter, lines.lines({.length_rate_m_s = 0.114,
                                                    .elevation_rate_rad_s = 0.1,
                                                    .azimuth_rate_rad_s = -0.2,
                                                    .yaw_rate_rad_s = 0.3},
                                                   {0}));
  ASSERT_EQ(sent.size(), 2U);
  const auto position = parse_command_line(sent[0], 0.00285).position;
  ASSERT_TRUE(position);
  EXPECT_NEAR(position->length_rate_m_s, 0.114, 1e-9);
  EXPECT_NEAR(position->elevation_rate_rad_s, 0.1, 1e-9);
  EXPECT_NEAR(position->azimuth_rate_rad_s, -0.2, 1e-9);
  EXPECT_NEAR(parse_command_line(sent[1], 0.00285).yaw_rate_rad_s.value(), 0.3, 1e-9);
  for (const char* line : {"", "Pos2", "Pos2 1,2", "Yaw", "Yaw x", "Position 1,2,3"}) {
    const ParsedCommand none = parse_command_line(line, 0.00285);
    EXPECT_FALSE(none.position || none.yaw_rate_rad_s) << line;
  }
}

}  // namespace
}  // namespace stillkite
