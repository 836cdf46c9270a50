#include "live/sensors/sensor_lines.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

constexpr TelemetryConfig kAllSensors{.imu = ImuMessage::json,
                                      .attitude = AttitudeMessage::json,
                                      .height = HeightMessage::json_range,
                                      .json = std::nullopt};

SensorLine line_from(const std::string& text) {
  const ParsedSensorLine parsed = parse_sensor_line(text);
  EXPECT_TRUE(parsed.line) << text << ": " << parsed.problem;
  return parsed.line.value_or(SensorLine{});
}

TEST(SensorLines, ReadsEachReading) {
  const SensorLine line = line_from(
      R"({"schema": 1, "timestamp": 1700000000123456789, "angular_rate": [0.1, -0.2, 3e-1],
          "specific_force": [0, 1, 9.81], "attitude": [0.6, 0, 0, 0.8], "range": 2.5,
          "height": -3})");
  EXPECT_EQ(line.sender_ns, 1'700'000'000'123'456'789);
  EXPECT_EQ(line.imu->angular_rate_in_body_rad_s, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(line.imu->specific_force_in_body_m_s2, Eigen::Vector3d(0, 1, 9.81));
  EXPECT_TRUE(line.world_from_body->isApprox(Eigen::Quaterniond(0.6, 0, 0, 0.8), 1e-15));
  EXPECT_EQ(line.range_m, 2.5);
  EXPECT_EQ(line.height_m, -3);
  EXPECT_FALSE(line_from(R"({"schema":1,"range":0})").sender_ns);
}

TEST(SensorLines, NamesTheReasonOfARejection) {
  const std::pair<const char*, const char*> rejected[] = {
      {"", "no JSON object"},
      {"[1]", "no JSON object"},
      {R"({"schema":1,"range":1)", "no JSON object"},
      {R"({"range":1})", "expected \"schema\": 1"},
      {R"({"schema":2,"range":1})", "expected \"schema\": 1"},
      {R"({"schema":1})", "no reading"},
      {R"({"schema":1,"ranges":1})", "unknown key; known: schema"},
      {R"({"schema":1,"range":"1"})", "range: expected a number in [0, 100000]"},
      {R"({"schema":1,"range":-1})", "range: expected a number in [0, 100000]"},
      {R"({"schema":1,"range":null})", "range: expected a number"},
      {R"({"schema":1,"height":1e400})", "no JSON object"},
      {R"({"schema":1,"attitude":[1,0,0]})", "attitude: expected 4 numbers"},
      {R"({"schema":1,"attitude":[0.5,0,0,0]})", "attitude: expected a unit quaternion"},
      {R"({"schema":1,"angular_rate":[0,0,0]})", "belong together"},
      {R"({"schema":1,"angular_rate":[0,0,101],"specific_force":[0,0,9]})",
       "angular_rate: expected 3 numbers within +-100"},
      {R"({"schema":1,"range":1,"timestamp":1.5})", "timestamp: expected a whole number"},
      {R"({"schema":1,"range":1,"timestamp":-1})", "timestamp: expected a whole number"},
      {R"({"schema":1,"range":1,"timestamp":18446744073709551615})", "timestamp: expected"}};
  for (const auto& [text, reason] : rejected) {
    const ParsedSensorLine parsed = parse_sensor_line(text);
    EXPECT_FALSE(parsed.line) << text;
    EXPECT_NE(parsed.problem.find(reason), std::string::npos) << text << ": " << parsed.problem;
  }
}

TEST(SensorLines, WithoutATimestampTheArrivalIsTheStamp) {
  SensorLineReader reader(kAllSensors);
  const auto samples = reader.read(line_from(R"({"schema":1,"range":2.5})"), {7});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(std::get<HeightSample>(samples[0]).stamp, Timestamp{7});
  EXPECT_EQ(std::get<HeightSample>(samples[0]).height_m, 2.5);
}

// The sender's clock is 1 s behind; every second line is 20 ms late.
TEST(SensorLines, TimestampsAreMappedByTheSmallestDelay) {
  constexpr std::int64_t kOffset_ns = 1'000'000'000, kLate_ns = 20'000'000, kStep_ns = 10'000'000;
  constexpr double kMaxError_ns = 5e5;
  SensorLineReader reader(kAllSensors);
  SensorLine line = line_from(R"({"schema":1,"attitude":[1,0,0,0]})");
  for (int i = 0; i < 100; ++i) {
    line.sender_ns = kStep_ns * i;
    const Timestamp arrival{kStep_ns * i + kOffset_ns + (i % 2) * kLate_ns};
    const auto samples = reader.read(line, arrival);
    ASSERT_EQ(samples.size(), 1U);
    EXPECT_NEAR(static_cast<double>(std::get<AttitudeSample>(samples[0]).stamp.ns),
                static_cast<double>(kStep_ns * i + kOffset_ns), kMaxError_ns);
  }
}

TEST(SensorLines, GivesOnlyNewerReadingsOfConfiguredSensors) {
  SensorLineReader reader({.imu = ImuMessage::none,
                           .attitude = AttitudeMessage::quaternion,
                           .height = HeightMessage::json_height,
                           .json = std::nullopt});
  const SensorLine line = line_from(
      R"({"schema":1,"attitude":[1,0,0,0],"range":2,"height":3,"angular_rate":[0,0,0],
          "specific_force":[0,0,9.8]})");
  const auto samples = reader.read(line, {5});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(std::get<HeightSample>(samples[0]).height_m, 3);
  EXPECT_TRUE(reader.read(line, {5}).empty());
  EXPECT_EQ(reader.read(line, {6}).size(), 1U);
}

}  // namespace
}  // namespace stillkite
