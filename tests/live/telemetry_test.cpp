#include "live/mavlink/telemetry.hpp"

#include <gtest/gtest.h>

#include "live/mavlink/parser.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"

namespace stillkite::mavlink {
namespace {

template <Message M>
Packet packet_of(const M& message, Sender sender = {.component = 1}) {
  Parser parser;
  parser.add(encode(message, sender).bytes());
  return parser.next().value();
}

constexpr Timestamp kArrival{5'000'000'000};

TEST(Telemetry, ReadsHighresImuInForwardLeftUpAxes) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  const auto sample = telemetry.read(packet_of(HighresImu{.time_usec = 100,
                                                          .xacc = 1,
                                                          .yacc = 2,
                                                          .zacc = -9.8f,
                                                          .xgyro = 0.1f,
                                                          .ygyro = 0.2f,
                                                          .zgyro = 0.3f}),
                                     kArrival);
  const auto& imu = std::get<ImuSample>(sample.value());
  EXPECT_TRUE(imu.specific_force_in_body_m_s2.isApprox(Eigen::Vector3d(1, -2, 9.8), 1e-6));
  EXPECT_TRUE(imu.angular_rate_in_body_rad_s.isApprox(Eigen::Vector3d(0.1, -0.2, -0.3), 1e-6));
  EXPECT_EQ(imu.stamp, kArrival);
}

TEST(Telemetry, ReadsScaledAndRawImuInMilliUnits) {
  const auto rest_of = [](const auto& message, ImuMessage kind) {
    Telemetry telemetry({.imu = kind}, 1);
    return std::get<ImuSample>(telemetry.read(packet_of(message), kArrival).value());
  };
  ScaledImu2 second;
  second.zacc = -1000;
  for (const ImuSample& imu :
       {rest_of(ScaledImu{.zacc = -1000}, ImuMessage::scaled),
        rest_of(RawImu{.zacc = -1000}, ImuMessage::raw), rest_of(second, ImuMessage::scaled2)}) {
    EXPECT_NEAR(imu.specific_force_in_body_m_s2.z(), 9.80665, 1e-9);
  }
}

TEST(Telemetry, ReadsOnlyTheConfiguredMessage) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  EXPECT_FALSE(telemetry.read(packet_of(ScaledImu{.zacc = -1000}), kArrival));
  EXPECT_FALSE(telemetry.read(packet_of(AttitudeQuaternion{.q1 = 1}), kArrival));
}

TEST(Telemetry, ReadsAttitudeInForwardLeftUpAxes) {
  Telemetry telemetry({.attitude = AttitudeMessage::quaternion}, 1);
  const float c = std::cos(0.1f), s = std::sin(0.1f);
  const auto nose_up =
      telemetry.read(packet_of(AttitudeQuaternion{.time_boot_ms = 1, .q1 = c, .q3 = s}), kArrival);
  const Eigen::Quaterniond q = std::get<AttitudeSample>(nose_up.value()).world_from_body;
  // our pitch is positive nose down
  EXPECT_GT((q * Eigen::Vector3d::UnitX()).z(), 0.1);
  EXPECT_FALSE(telemetry.read(packet_of(AttitudeQuaternion{.time_boot_ms = 2}), kArrival));
}

TEST(Telemetry, ReadsTheRangeFinderThatLooksDown) {
  Telemetry telemetry({.height = HeightMessage::distance_sensor}, 1);
  DistanceSensor message{.time_boot_ms = 1,
                         .min_distance = 20,
                         .max_distance = 4000,
                         .current_distance = 1234,
                         .orientation = 25};
  EXPECT_DOUBLE_EQ(
      std::get<HeightSample>(telemetry.read(packet_of(message), kArrival).value()).height_m, 12.34);
  message.time_boot_ms = 2;
  message.orientation = 0;
  EXPECT_FALSE(telemetry.read(packet_of(message), kArrival));
  message.orientation = 25;
  message.current_distance = message.max_distance;
  EXPECT_FALSE(telemetry.read(packet_of(message), kArrival));
}

TEST(Telemetry, ReadsRelativeHeight) {
  Telemetry telemetry({.height = HeightMessage::global_position}, 1);
  const auto sample = telemetry.read(packet_of(GlobalPositionInt{.relative_alt = -1500}), kArrival);
  EXPECT_DOUBLE_EQ(std::get<HeightSample>(sample.value()).height_m, -1.5);
}

TEST(Telemetry, RejectsReadingsThatAreNotNewer) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  const Packet packet = packet_of(HighresImu{.time_usec = 100, .zacc = -9.8f});
  EXPECT_TRUE(telemetry.read(packet, kArrival));
  EXPECT_FALSE(telemetry.read(packet, {kArrival.ns + 1000}));
}

TEST(Telemetry, RejectsReadingsThatAreNotFinite) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  EXPECT_FALSE(telemetry.read(packet_of(HighresImu{.zacc = std::nanf("")}), kArrival));
}

TEST(Telemetry, IgnoresOtherSystemsAndComponents) {
  Telemetry telemetry({.attitude = AttitudeMessage::quaternion}, 1);
  const AttitudeQuaternion level{.q1 = 1};
  constexpr std::uint8_t kGimbal = 154;
  EXPECT_FALSE(telemetry.read(packet_of(level, {.system = 1, .component = kGimbal}), kArrival));
  EXPECT_FALSE(telemetry.read(packet_of(level, {.system = 2, .component = 1}), kArrival));
  EXPECT_TRUE(telemetry.read(packet_of(level), kArrival));
}

TEST(Telemetry, RejectsAnInvalidSignalAndAnImpossibleTime) {
  Telemetry range({.height = HeightMessage::distance_sensor}, 1);
  EXPECT_FALSE(range.read(
      packet_of(DistanceSensor{
          .max_distance = 4000, .current_distance = 1234, .orientation = 25, .signal_quality = 1}),
      kArrival));
  Telemetry imu({.imu = ImuMessage::highres}, 1);
  EXPECT_FALSE(imu.read(packet_of(HighresImu{.time_usec = UINT64_MAX}), kArrival));
}

TEST(Telemetry, SubtractsHalfOfTheShortestRoundTrip) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  EXPECT_FALSE(
      telemetry.read(packet_of(Timesync{.tc1 = 77, .ts1 = kArrival.ns - 4'000'000}), kArrival));
  const auto sample = telemetry.read(packet_of(HighresImu{.zacc = -9.8f}), kArrival);
  EXPECT_EQ(std::get<ImuSample>(sample.value()).stamp.ns, kArrival.ns - 2'000'000);
}

// Replies to other components: times of another clock, down to the smallest number.
TEST(Telemetry, IgnoresRoundTripsOfAnotherClock) {
  Telemetry telemetry({.imu = ImuMessage::highres}, 1);
  for (const std::int64_t sent_ns :
       {INT64_MIN, std::int64_t{-1}, kArrival.ns - 1'000'000'001, kArrival.ns, INT64_MAX}) {
    EXPECT_FALSE(telemetry.read(packet_of(Timesync{.tc1 = 77, .ts1 = sent_ns}), kArrival));
  }
  const auto sample = telemetry.read(packet_of(HighresImu{.zacc = -9.8f}), kArrival);
  EXPECT_EQ(std::get<ImuSample>(sample.value()).stamp, kArrival);
}

}  // namespace
}  // namespace stillkite::mavlink
