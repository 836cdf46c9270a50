#include "app/page_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "app/flight_alarms.hpp"
#include "app/level_displacement.hpp"
#include "app/page_image_encoder.hpp"
#include "tests/app/page_snapshot_sample.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

Eigen::Quaterniond yawed(double yaw_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

// 0.3 m forward and 0.4 m left of the pose to hold, whatever its heading and the present yaw.
TEST(LevelDisplacement, IsInTheAxesOfThePoseToHold) {
  const PageSnapshot snapshot = snapshot_at({0});
  const RigidTransform& body_from_camera = snapshot.body_from_camera;
  for (const double heading_rad : {0.0, 0.7, -2.5}) {
    for (const double yaw_rad : {0.0, 1.2, 3.0}) {
      MotionEstimate motion = snapshot.step.motion;
      motion.reference_from_camera =
          body_from_camera.rotation.conjugate() * yawed(yaw_rad) * body_from_camera.rotation;
      const LevelDisplacement level =
          level_displacement(motion, yawed(heading_rad + yaw_rad), body_from_camera);
      EXPECT_TRUE(level.displacement.isApprox(Eigen::Vector3d(0.3, 0.4, 0), 1e-9));
      EXPECT_NEAR(level.yaw_rad, yaw_rad, 1e-9);
    }
  }
}

TEST(LevelDisplacement, EllipseContains95Percent) {
  Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.04, 1).asDiagonal();
  const DisplacementEllipse ellipse = horizontal_ellipse(covariance);
  const double scale = std::sqrt(-2 * std::log(0.05));  // of two degrees of freedom
  EXPECT_NEAR(ellipse.major, 0.2 * scale, 1e-6);
  EXPECT_NEAR(ellipse.minor, 0.1 * scale, 1e-6);
  EXPECT_NEAR(std::abs(std::sin(ellipse.angle_rad)), 1, 1e-9);
}

HistorySample sample_at(double t_s, Verdict verdict = Verdict::ok, double latency_ms = 20) {
  return {.time = from_seconds(t_s), .latency_ms = latency_ms, .verdict = verdict};
}

TEST(PageHistory, KeepsTheWorstOfAnInterval) {
  PageHistory history;
  history.add(sample_at(10, Verdict::ok, 20));
  history.add(sample_at(10.1, Verdict::lost, 90));
  history.add(sample_at(10.2, Verdict::ok, 30));
  EXPECT_TRUE(history.take().empty());
  history.add(sample_at(10.3, Verdict::still));
  history.add(sample_at(12));
  const std::vector<HistorySample> samples = history.take();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].number, 0);
  EXPECT_EQ(samples[0].time, from_seconds(10.2));
  EXPECT_EQ(samples[0].verdict, Verdict::lost);
  EXPECT_EQ(samples[0].latency_ms, 90);
  EXPECT_EQ(samples[1].number, 1);
  EXPECT_EQ(samples[1].verdict, Verdict::still);
}

TEST(PageHistory, LengthsWithoutScaleAreUnknownUnlessInHeights) {
  PageSnapshot snapshot = snapshot_at({0});
  EXPECT_DOUBLE_EQ(history_sample(snapshot, {}).speed, 0.5);
  EXPECT_DOUBLE_EQ(history_sample(snapshot, {}).displacement_m, 0.5);
  snapshot.step.estimate.scale = ScaleSource::none;
  EXPECT_DOUBLE_EQ(history_sample(snapshot, {}).height, 2);
  snapshot.step.estimate.source = EstimateSource::reference;
  snapshot.step.motion.displacement_kind = DisplacementKind::direction;
  EXPECT_TRUE(std::isnan(history_sample(snapshot, {}).height));
  EXPECT_TRUE(std::isnan(history_sample(snapshot, {}).displacement_m));
}

TEST(PageState, RatesAreThoseOfTheLastSeconds) {
  EXPECT_FALSE(image_rates({}).used_per_s);
  std::vector<HistorySample> samples;
  for (int i = 0; i <= 80; ++i) {  // 20 s: 20 images per second of 30, at first of 20
    HistorySample sample = sample_at(0.25 * i);
    sample.used_images = 5 * i;
    sample.decoded_images = 5 * i + std::max(0, 5 * (i - 40)) / 2;
    sample.replaced_images = sample.decoded_images - sample.used_images;
    samples.push_back(sample);
  }
  EXPECT_NEAR(image_rates(samples).used_per_s.value(), 20, 1e-9);
  EXPECT_NEAR(image_rates(samples).dropped_ratio.value(), 1.0 / 3, 1e-9);
}

TEST(PageState, UnknownValuesAreNull) {
  const json empty = page_json({}, {0}, -1);
  EXPECT_TRUE(empty.at("estimate").is_null());
  EXPECT_TRUE(empty.at("control").is_null());
  PageState state{.newest = std::make_shared<const PageSnapshot>(snapshot_at(from_seconds(10))),
                  .status = {.has_station = true, .is_engaged = true},
                  .samples = {sample_at(9), sample_at(9.5)},
                  .messages = {{from_seconds(8), "tether: engaged"}}};
  state.samples[1].number = 1;
  const json page = page_json(state, from_seconds(10.5), 0);
  EXPECT_EQ(page.at("estimate").at("speed"), 0.5);
  EXPECT_NEAR(page.at("estimate").at("displacement").at("left").get<double>(), 0.4, 1e-9);
  EXPECT_EQ(page.at("estimate").at("age_s"), 0.5);
  EXPECT_EQ(page.at("control").at("engaged"), true);
  ASSERT_EQ(page.at("samples").size(), 1U);
  EXPECT_EQ(page.at("samples").at(0).at(1), -1);
  EXPECT_EQ(json::parse(page.dump()).at("samples").at(0).at(2), nullptr);
  EXPECT_EQ(page.at("messages").at(0).at(0), 2.5);
}

std::vector<std::string> alarms_of(const PageSnapshot& snapshot, const FlightStatus& status,
                                   double now_s = 10.1) {
  return flight_alarms({.newest = std::make_shared<const PageSnapshot>(snapshot), .status = status},
                       from_seconds(now_s));
}

TEST(PageState, ReplayHasItsTimeAndNoAlarmAtItsEnd) {
  const Timestamp now{100'000'000'000};
  PageState state;
  state.newest = std::make_shared<const PageSnapshot>(snapshot_at({now.ns - 5'000'000'000}));
  EXPECT_TRUE(page_json(state, now, -1)["replay"].is_null());
  EXPECT_EQ(flight_alarms(state, now).at(0), "No image for 5 s");
  state.status.replay = FlightStatus::Replay{.speed = 4, .time_s = 12.5, .has_ended = true};
  const nlohmann::json replay = page_json(state, now, -1)["replay"];
  EXPECT_EQ(replay["speed"], 4);
  EXPECT_EQ(replay["time_s"], 12.5);
  EXPECT_EQ(replay["ended"], true);
  EXPECT_EQ(flight_alarms(state, now), std::vector<std::string>{"End of the record"});
}

TEST(FlightAlarms, AreEmptyInAMeasuredFlight) {
  PageSnapshot snapshot = snapshot_at(from_seconds(10));
  EXPECT_TRUE(alarms_of(snapshot, {.has_station = true}).empty());
  snapshot.step.decision.reason = HoldReason::within_dead_band;
  EXPECT_TRUE(alarms_of(snapshot, {.has_station = true, .is_engaged = true}).empty());
}

TEST(FlightAlarms, NameWhatIsMissing) {
  using Alarms = std::vector<std::string>;
  EXPECT_EQ(flight_alarms({}, {0}), Alarms{"No image yet"});
  PageSnapshot snapshot = snapshot_at(from_seconds(10));
  EXPECT_EQ(alarms_of(snapshot, {}, 13), Alarms{"No image for 3 s"});
  snapshot.measured = from_seconds(7.5);
  snapshot.step.estimate.verdict = Verdict::too_little_texture;
  snapshot.step.decision.reason = HoldReason::not_measured;
  EXPECT_EQ(alarms_of(snapshot, {.has_station = true, .is_engaged = true}),
            (Alarms{"Engaged, but no image is measured",
                    "Motion not measured for 2.5 s: too little texture"}));
  snapshot = snapshot_at(from_seconds(10));
  snapshot.step.decision.reason = HoldReason::station_silent;
  EXPECT_EQ(alarms_of(snapshot, {.has_station = true}),
            Alarms{"Engage is not possible: the ground station is silent"});
  snapshot.step.decision.reason = HoldReason::stopped;
  EXPECT_EQ(alarms_of(snapshot, {.has_station = true, .is_stopped = true}),
            Alarms{"Stopped: no commands for the rest of the flight"});
  snapshot.step.estimate.scale = ScaleSource::none;
  EXPECT_EQ(alarms_of(snapshot, {}), Alarms{"No metric scale: lengths are in initial heights"});
}

TEST(PageImageEncoder, CodesTenImagesPerSecondOfAtMost800Pixels) {
  PageSnapshot snapshot = snapshot_at({0});
  snapshot.camera.width_px = 1600;
  snapshot.camera.height_px = 1200;
  snapshot.grey = cv::Mat(1200, 1600, CV_8UC1, cv::Scalar(120));
  PageImageEncoder encoder;
  snapshot.number = 1;
  const auto first = encoder.encode(snapshot, -1, from_seconds(10));
  ASSERT_TRUE(first);
  EXPECT_EQ(cv::imdecode(*first->jpeg, cv::IMREAD_COLOR).size(), cv::Size(800, 600));
  EXPECT_FALSE(encoder.encode(snapshot, 1, from_seconds(11)));
  snapshot.number = 2;
  EXPECT_TRUE(encoder.encode(snapshot, 1, from_seconds(11)));
  snapshot.number = 3;
  EXPECT_FALSE(encoder.encode(snapshot, 2, from_seconds(11.05)));
  EXPECT_EQ(encoder.encode(snapshot, -1, from_seconds(11.05))->number, 2);
  EXPECT_EQ(encoder.encode(snapshot, 2, from_seconds(11.11))->number, 3);
}

}  // namespace
}  // namespace stillkite
