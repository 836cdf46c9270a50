#include "app/flight_estimator.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/results/estimate_json.hpp"
#include "live/mavlink/parser.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/operator/operator_command.hpp"
#include "live/tether/station_lines.hpp"

namespace stillkite {
namespace {

using mavlink::AttitudeQuaternion;
using mavlink::DistanceSensor;
using mavlink::GlobalPositionInt;

constexpr std::int64_t kEpoch_ns = 1'000'000'000'000;
constexpr int kPeriod_ms = 40;

FlyConfig config_with(const TelemetryConfig& telemetry, std::optional<double> height_m) {
  FlyConfig config;
  config.source.path = "udp://:5600";
  config.calibration.camera = CameraConfig{.width_px = 320,
                                           .height_px = 240,
                                           .focal_x_px = 240,
                                           .focal_y_px = 240,
                                           .centre_x_px = 159.5,
                                           .centre_y_px = 119.5};
  config.initial.height_m = height_m;
  config.live.mavlink = "udp://:14550";
  config.live.telemetry = telemetry;
  return config;
}

Timestamp at_ms(std::int64_t t_ms) {
  return {kEpoch_ns + 1'000'000 * t_ms};
}

// The autopilot's clock starts at 0; the delay is constant, so that stamps are those of arrival.
template <mavlink::Message M>
void receive(FlightEstimator& estimator, M message, std::int64_t t_ms) {
  message.time_boot_ms = static_cast<std::uint32_t>(t_ms);
  mavlink::Sender sender{.component = 1};
  mavlink::Parser parser;
  parser.add(mavlink::encode(message, sender).bytes());
  estimator.receive(parser.next().value(), at_ms(t_ms));
}

// Noise that moves by one pixel per frame.
Frame frame_at(std::int64_t t_ms) {
  static const cv::Mat ground = [] {
    cv::Mat out(240, 1000, CV_8UC1);
    cv::RNG random(1);
    random.fill(out, cv::RNG::UNIFORM, 0, 256);
    return out;
  }();
  const int shift = static_cast<int>(t_ms / kPeriod_ms);
  return {.stamp = at_ms(t_ms),
          .index = shift,
          .grey = ground.colRange(shift, shift + 320).clone(),
          .stamp_sigma_s = 1e-4};
}

DistanceSensor range_of(double distance_m) {
  return {.min_distance = 10,
          .max_distance = 10'000,
          .current_distance = static_cast<std::uint16_t>(100 * distance_m),
          .orientation = 25};
}

TEST(FlightEstimator, IsReadyOnceTheInitialStateHasArrived) {
  FlightEstimator estimator(config_with(
      {.attitude = AttitudeMessage::quaternion, .height = HeightMessage::distance_sensor},
      std::nullopt));
  EXPECT_FALSE(estimator.is_ready(at_ms(50)));
  receive(estimator, range_of(12), 0);
  receive(estimator, range_of(12), 100);
  EXPECT_FALSE(estimator.is_ready(at_ms(50)));
  const AttitudeQuaternion nose_up{.q1 = std::cos(0.05f), .q3 = std::sin(0.05f)};
  receive(estimator, nose_up, 0);
  EXPECT_TRUE(estimator.is_ready(at_ms(50)));
  EXPECT_FALSE(estimator.is_ready(at_ms(400)));
  receive(estimator, nose_up, 100);
  ASSERT_TRUE(estimator.is_ready(at_ms(50)));
  const NavigationEstimate first = estimator.step(frame_at(50), at_ms(50)).estimate;
  EXPECT_EQ(first.scale, ScaleSource::range);
  EXPECT_NEAR(first.world_from_body.translation.z(), 12 * std::cos(0.1), 1e-4);
  EXPECT_NEAR(to_euler(first.world_from_body.rotation).pitch_rad, -0.1, 1e-6);
}

TEST(FlightEstimator, SensorLinesAreTelemetry) {
  FlightEstimator estimator(config_with({.imu = ImuMessage::json,
                                         .attitude = AttitudeMessage::json,
                                         .height = HeightMessage::json_range,
                                         .json = "udp://:14600"},
                                        std::nullopt));
  const SensorLine nose_up{
      .imu = SensorLine::Imu{.angular_rate_in_body_rad_s = Eigen::Vector3d::Zero(),
                             .specific_force_in_body_m_s2 = Eigen::Vector3d(0, 0, 9.81)},
      .world_from_body = Eigen::Quaterniond(Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitY())),
      .range_m = 12};
  EXPECT_FALSE(estimator.is_ready(at_ms(50)));
  for (const int t_ms : {0, 20, 40, 60}) estimator.receive(nose_up, at_ms(t_ms));
  ASSERT_TRUE(estimator.is_ready(at_ms(50)));
  EXPECT_TRUE(estimator.has_telemetry_until(at_ms(60)));
  EXPECT_FALSE(estimator.has_telemetry_until(at_ms(61)));
  const NavigationEstimate first = estimator.step(frame_at(50), at_ms(50)).estimate;
  EXPECT_EQ(first.scale, ScaleSource::range);
  EXPECT_NEAR(first.world_from_body.translation.z(), 12 * std::cos(0.1), 1e-9);
  EXPECT_NEAR(to_euler(first.world_from_body.rotation).pitch_rad, -0.1, 1e-9);
}

TEST(FlightEstimator, BarometerIsAlignedToTheInitialHeight) {
  FlightEstimator estimator(config_with({.height = HeightMessage::global_position}, 20));
  for (int t_ms = 0; t_ms <= 2000; t_ms += kPeriod_ms) {
    receive(estimator, GlobalPositionInt{.relative_alt = 3000}, t_ms);
    receive(estimator, GlobalPositionInt{.relative_alt = 3000}, t_ms + 1);
    if (t_ms < kPeriod_ms) continue;
    const NavigationEstimate estimate = estimator.step(frame_at(t_ms), at_ms(t_ms)).estimate;
    EXPECT_NEAR(estimate.world_from_body.translation.z(), 20, 0.1);
  }
}

TEST(FlightEstimator, ExpectsReadingsOfSensorsThatAreFastAndNotSilent) {
  FlightEstimator estimator(config_with({.imu = ImuMessage::scaled}, 20));
  EXPECT_TRUE(estimator.has_telemetry_until(at_ms(0)));
  receive(estimator, mavlink::ScaledImu{.zacc = -1000}, 5);
  receive(estimator, mavlink::ScaledImu{.zacc = -1000}, 10);
  EXPECT_TRUE(estimator.has_telemetry_until(at_ms(10)));
  EXPECT_FALSE(estimator.has_telemetry_until(at_ms(11)));
  EXPECT_TRUE(estimator.has_telemetry_until(at_ms(600)));
  FlightEstimator slow(config_with({.imu = ImuMessage::scaled}, 20));
  receive(slow, mavlink::ScaledImu{.zacc = -1000}, 0);
  receive(slow, mavlink::ScaledImu{.zacc = -1000}, 100);
  EXPECT_TRUE(slow.has_telemetry_until(at_ms(110)));
}

TEST(FlightEstimator, SameInputsGiveTheSameEstimates) {
  const FlyConfig config = config_with({.height = HeightMessage::distance_sensor}, 20);
  FlightEstimator first(config), second(config);
  for (int t_ms = 0; t_ms < 1000; t_ms += kPeriod_ms) {
    for (FlightEstimator* estimator : {&first, &second}) {
      receive(*estimator, range_of(20), t_ms);
    }
    NavigationEstimate a = first.step(frame_at(t_ms), at_ms(t_ms)).estimate;
    NavigationEstimate b = second.step(frame_at(t_ms), at_ms(t_ms)).estimate;
    a.stage_ms = b.stage_ms = {};
    EXPECT_EQ(estimate_json(a), estimate_json(b));
  }
}

FlyConfig tethered_config() {
  FlyConfig config = config_with({}, 20);
  config.live.mavlink.reset();
  config.live.tether.port = "serial:/dev/none:115200";
  return config;
}

// Level attitude, tether of 2 m and 1 rad, ground station in flight.
void receive_station(FlightEstimator& estimator, std::int64_t t_ms, int mode = 1) {
  const StationMessage messages[] = {
      StationStatus{.mode = mode, .relative_length_counts = 2 / 0.00285}, DroneAttitude{},
      DronePosition{.elevation_from_zenith_rad = 0.57}, DroneStatus{.mode = 2}};
  for (const StationMessage& message : messages) estimator.receive(message, at_ms(t_ms));
}

OperatorCommand command_at(OperatorAction action, std::int64_t t_ms) {
  return {.action = action, .note = {}, .arrival = at_ms(t_ms)};
}

TEST(FlightEstimator, CommandsOnlyWhileAnOperatorHasEngaged) {
  FlightEstimator estimator(tethered_config());
  EXPECT_FALSE(estimator.is_ready(at_ms(0)));
  const auto decision_at = [&](std::int64_t t_ms, int mode = 1) {
    receive_station(estimator, t_ms, mode);
    return estimator.step(frame_at(t_ms), at_ms(t_ms)).decision;
  };
  receive_station(estimator, 0);
  EXPECT_TRUE(estimator.is_ready(at_ms(0)));
  for (int t_ms = 0; t_ms < 400; t_ms += kPeriod_ms) {
    const HoldDecision held = decision_at(t_ms);
    EXPECT_EQ(held.action, HoldAction::hold);
    EXPECT_EQ(held.reason, HoldReason::not_engaged);
  }
  // 10 px at 20 m and f = 240 px: 0.8 m from the reference, too far to engage
  EXPECT_TRUE(estimator.receive(command_at(OperatorAction::engage, 400)));
  EXPECT_FALSE(estimator.receive(command_at(OperatorAction::hold_here, 400)));
  receive_station(estimator, 400);
  EXPECT_TRUE(estimator.step(frame_at(400), at_ms(400)).is_setpoint_moved);
  EXPECT_FALSE(estimator.receive(command_at(OperatorAction::engage, 410)));
  HoldDecision last;
  for (int t_ms = 440; t_ms < 800; t_ms += kPeriod_ms) last = decision_at(t_ms);
  EXPECT_EQ(last.action, HoldAction::command);
  EXPECT_EQ(last.reason, HoldReason::none);
  // 9 px since the pose to hold are 0.75 m; the controller uses up to 0.5 m
  EXPECT_NEAR(last.position_error_in_station_m.norm(), 0.5, 1e-9);
  EXPECT_EQ(decision_at(800, 2).reason, HoldReason::station_mode);
  EXPECT_EQ(decision_at(840).reason, HoldReason::not_engaged);
}

TEST(FlightEstimator, HoldsWhileTheStationIsSilent) {
  FlightEstimator estimator(tethered_config());
  receive_station(estimator, 0);
  static_cast<void>(estimator.step(frame_at(0), at_ms(0)));
  EXPECT_FALSE(estimator.receive(command_at(OperatorAction::engage, 10)));
  EXPECT_NE(estimator.step(frame_at(40), at_ms(40)).decision.reason, HoldReason::station_silent);
  for (int t_ms = 80; t_ms < 1000; t_ms += kPeriod_ms) {
    const HoldReason reason = estimator.step(frame_at(t_ms), at_ms(t_ms)).decision.reason;
    EXPECT_EQ(reason == HoldReason::station_silent, t_ms > 200) << t_ms;
  }
  receive_station(estimator, 1000);
  EXPECT_NE(estimator.step(frame_at(1000), at_ms(1000)).decision.reason,
            HoldReason::station_silent);
}

TEST(FlightEstimator, CalibrationOfAnotherSizeIsAnInputError) {
  FlyConfig config = config_with({}, 20);
  config.calibration.camera->width_px = 640;
  FlightEstimator estimator(config);
  EXPECT_THROW(static_cast<void>(estimator.step(frame_at(0), at_ms(0))), InputError);
}

}  // namespace
}  // namespace stillkite
