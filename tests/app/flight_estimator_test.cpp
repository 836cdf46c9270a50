#include "app/flight_estimator.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/results/estimate_json.hpp"
#include "live/mavlink/parser.hpp"
#include "live/mavlink/sensor_messages.hpp"

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
  FlightEstimator estimator(
      config_with({.attitude = true, .height = HeightMessage::distance_sensor}, std::nullopt));
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
  const NavigationEstimate first = estimator.step(frame_at(50));
  EXPECT_EQ(first.scale, ScaleSource::range);
  EXPECT_NEAR(first.world_from_body.translation.z(), 12 * std::cos(0.1), 1e-4);
  EXPECT_NEAR(to_euler(first.world_from_body.rotation).pitch_rad, -0.1, 1e-6);
}

TEST(FlightEstimator, BarometerIsAlignedToTheInitialHeight) {
  FlightEstimator estimator(config_with({.height = HeightMessage::global_position}, 20));
  for (int t_ms = 0; t_ms <= 2000; t_ms += kPeriod_ms) {
    receive(estimator, GlobalPositionInt{.relative_alt = 3000}, t_ms);
    receive(estimator, GlobalPositionInt{.relative_alt = 3000}, t_ms + 1);
    if (t_ms < kPeriod_ms) continue;
    const NavigationEstimate estimate = estimator.step(frame_at(t_ms));
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
    NavigationEstimate a = first.step(frame_at(t_ms)), b = second.step(frame_at(t_ms));
    a.stage_ms = b.stage_ms = {};
    EXPECT_EQ(estimate_json(a), estimate_json(b));
  }
}

TEST(FlightEstimator, CalibrationOfAnotherSizeIsAnInputError) {
  FlyConfig config = config_with({}, 20);
  config.calibration.camera->width_px = 640;
  FlightEstimator estimator(config);
  EXPECT_THROW(static_cast<void>(estimator.step(frame_at(0))), InputError);
}

}  // namespace
}  // namespace stillkite
