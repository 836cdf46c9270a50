#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "navigation/motion_conversion.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

class Sensors : public testing::TestWithParam<Mode> {
 protected:
  [[nodiscard]] Navigator navigator(const InitialState& start) const {
    const auto& flight = rendered_flight();
    return {flight.record.camera, flight.record.body_from_camera, {}, start, {.mode = GetParam()}};
  }
};

TEST_P(Sensors, HeightCorrectsInitialHeightError) {
  const auto& flight = rendered_flight();
  InitialState biased = flight.start();
  biased.world_from_body.translation.z() *= 1.05;
  Navigator estimator = navigator(biased);
  NavigationEstimate e;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    SensorReadings readings;
    const bool reads = i > 0 && i < 40;
    if (reads) readings.height_m = flight.truth(i).translation.z();
    e = estimator.step(flight.frames[i], readings);
    EXPECT_EQ(e.scale, i == 0 ? ScaleSource::initial_height : ScaleSource::range);
    const double age_s =
        reads || i == 0 ? 0.0 : seconds_between(flight.frames[39].stamp, flight.frames[i].stamp);
    EXPECT_NEAR(e.scale_age_s, age_s, 1e-9) << i;
  }
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_NEAR(e.world_from_body.translation.z(), truth.translation.z(), 0.1);
  EXPECT_LT((e.world_from_body.translation - truth.translation).norm(), 0.4);
  // twists begin with the second frame
  const Twist& last = flight.record.twists_in_camera.back().twist;
  EXPECT_LT((e.twist_in_camera.velocity_m_s - last.velocity_m_s).norm(),
            GetParam() == Mode::paper ? 0.5 : 0.15);
}

// Range finder with intermittent echo loss.
TEST_P(Sensors, RejectsHeightOutliers) {
  const auto& flight = rendered_flight();
  const std::size_t last = flight.frames.size() - 1;
  for (const double no_echo_m : {0.05, 40.0, 1e30}) {
    Navigator estimator = navigator(flight.start());
    NavigationEstimate e;
    for (std::size_t i = 0; i <= last; ++i) {
      SensorReadings readings;
      readings.height_m = i % 5 == 4 ? no_echo_m : flight.truth(i).translation.z();
      e = estimator.step(flight.frames[i], readings);
    }
    EXPECT_NEAR(e.world_from_body.translation.z(), flight.truth(last).translation.z(), 0.2)
        << no_echo_m;
  }
}

TEST_P(Sensors, AcceptsFifthConsecutiveOutlier) {
  const auto& flight = rendered_flight();
  InitialState biased = flight.start();
  biased.world_from_body.translation.z() *= 1.6;
  Navigator estimator = navigator(biased);
  for (std::size_t i = 0; i < 20; ++i) {
    SensorReadings readings;
    readings.height_m = flight.truth(i).translation.z();
    const NavigationEstimate e = estimator.step(flight.frames[i], readings);
    EXPECT_EQ(e.scale, i < 4 ? ScaleSource::initial_height : ScaleSource::range) << i;
    if (i < 4) continue;
    EXPECT_NEAR(e.world_from_body.translation.z(), flight.truth(i).translation.z(), 0.3) << i;
  }
}

// Range finder without an echo for a long time.
TEST_P(Sensors, RejectsRepeatedOutlierReading) {
  const auto& flight = rendered_flight();
  Navigator estimator = navigator(flight.start());
  for (std::size_t i = 0; i < 40; ++i) {
    SensorReadings readings;
    readings.height_m = i < 10 ? flight.truth(i).translation.z() : 60;
    const NavigationEstimate e = estimator.step(flight.frames[i], readings);
    EXPECT_NEAR(e.world_from_body.translation.z(), flight.truth(i).translation.z(), 0.3) << i;
  }
}

TEST(SensorReading, RangeIsAlongBodyAxis) {
  const Eigen::Quaterniond rolled = so3_exp({std::acos(0.5), 0, 0});
  EXPECT_NEAR(height_of_body_m(10, ScaleSource::range, rolled), 5, 1e-12);
  EXPECT_NEAR(height_of_body_m(10, ScaleSource::barometer, rolled), 10, 1e-12);
}

TEST_P(Sensors, FirstHeightSetsScale) {
  const auto& flight = rendered_flight();
  InitialState unscaled{flight.truth(0), ScaleSource::none};
  unscaled.world_from_body.translation.z() = 1;
  Navigator estimator = navigator(unscaled);
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    SensorReadings readings;
    if (i == 25) {
      readings.height_m = flight.truth(i).translation.z();
      readings.height_source = ScaleSource::barometer;
    }
    const NavigationEstimate e = estimator.step(flight.frames[i], readings);
    EXPECT_EQ(e.scale, i < 25 ? ScaleSource::none : ScaleSource::barometer);
    const double unit_m = i < 25 ? flight.truth(0).translation.z() : 1.0;
    EXPECT_LT((unit_m * e.world_from_body.translation - flight.truth(i).translation).norm(), 0.4)
        << i;
    const Twist& twist = flight.record.twists_in_camera[i == 0 ? 0 : i - 1].twist;
    if (i > 10) {
      EXPECT_LT((unit_m * e.twist_in_camera.velocity_m_s - twist.velocity_m_s).norm(), 0.6) << i;
    }
  }
}

// Non-finite readings leave the estimate unchanged.
TEST(SensorReading, NonFiniteIsIgnored) {
  const auto& flight = rendered_flight();
  for (const double non_finite : {std::nan(""), HUGE_VAL}) {
    const Eigen::Vector3d rate = Eigen::Vector3d::Constant(non_finite);
    const SensorReadings invalid{.mean_angular_rate_in_body_rad_s = rate,
                                 .height_m = non_finite,
                                 .attitude = Eigen::Quaterniond(non_finite, 0, 0, 0),
                                 .acceleration = Vector6d::Constant(non_finite),
                                 .inertial = {{flight.frames[5].stamp, rate, rate}}};
    for (const EstimatorConfig& estimator : {EstimatorConfig{.policy = Policy::flow},
                                             {.policy = Policy::flow, .mode = Mode::paper},
                                             {.policy = Policy::reference},
                                             {.policy = Policy::best},
                                             {.policy = Policy::fused}}) {
      const auto last = [&](const SensorReadings& at_some_frames) {
        Navigator navigator(flight.record.camera, flight.record.body_from_camera, {},
                            flight.start(), estimator);
        for (std::size_t i = 0; i < 12; ++i) {
          navigator.step(flight.frames[i], i > 4 && i < 11 ? at_some_frames : SensorReadings{});
        }
        return navigator.step(flight.frames[12]);
      };
      const NavigationEstimate with = last(invalid), without = last({});
      EXPECT_EQ(with.world_from_body.translation, without.world_from_body.translation)
          << name_of(estimator.policy) << non_finite;
      EXPECT_EQ(with.pose_covariance, without.pose_covariance);
    }
  }
}

// The displacement since the first frame is metric after a late first height.
TEST(FirstHeight, RescalesInitialPose) {
  const auto& flight = rendered_flight();
  const RigidTransform& mount = flight.record.body_from_camera;
  InitialState unscaled{flight.truth(0), ScaleSource::none};
  unscaled.world_from_body.translation.z() = 1;
  for (const EstimatorConfig& estimator : {EstimatorConfig{.policy = Policy::flow},
                                           {.policy = Policy::flow, .mode = Mode::paper},
                                           {.policy = Policy::best},
                                           {.policy = Policy::fused}}) {
    SCOPED_TRACE(name_of(estimator.policy));
    Navigator navigator(flight.record.camera, mount, {}, unscaled, estimator);
    Matrix6d initial_covariance;
    for (std::size_t i = 0; i < flight.frames.size(); ++i) {
      SensorReadings readings;
      if (i >= 25) readings.height_m = flight.truth(i).translation.z();
      const NavigationEstimate e = navigator.step(flight.frames[i], readings);
      if (i == 0) initial_covariance = e.pose_covariance;
      if (i < 25) continue;
      const MotionEstimate motion = motion_estimate(e, initial_covariance, mount);
      const RigidTransform truth = (flight.truth(0) * mount).inverse() * (flight.truth(i) * mount);
      ASSERT_EQ(motion.displacement_kind, DisplacementKind::metric) << i;
      EXPECT_LT((motion.displacement_in_reference - truth.translation).norm(), 0.5) << i;
    }
  }
}

TEST_P(Sensors, AttitudeCorrectsInitialTiltError) {
  const auto& flight = rendered_flight();
  InitialState biased = flight.start();
  biased.world_from_body.rotation = so3_exp({0.03, -0.02, 0}) * biased.world_from_body.rotation;
  Navigator estimator = navigator(biased);
  NavigationEstimate e;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    SensorReadings readings;
    readings.attitude = flight.truth(i).rotation;
    e = estimator.step(flight.frames[i], readings);
  }
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_LT(angle_between_rad(e.world_from_body.rotation, truth.rotation), 0.004);
}

// Ten black frames with a yaw of 10 degrees, measured by a gyroscope whose bias of 5 deg/s is
// learnt from the images before.
TEST(Gyro, PropagatesAttitudeWithoutImages) {
  const auto& flight = rendered_flight();
  const Eigen::Vector3d bias(0.087, -0.087, 0.087);
  for (const bool has_images_before : {true, false}) {
    Navigator estimator = flight.navigator();
    NavigationEstimate e;
    for (std::size_t i = 0; i < 20; ++i) {
      SensorReadings readings;
      if (has_images_before && i > 0) {
        const Eigen::Quaterniond& from = flight.truth(i - 1).rotation;
        readings.mean_angular_rate_in_body_rad_s =
            so3_log(from.conjugate() * flight.truth(i).rotation) / 0.04 + bias;
      }
      e = estimator.step(flight.frames[i], readings);
      EXPECT_NE(e.verdict, Verdict::lost);
    }
    const Eigen::Quaterniond before = e.world_from_body.rotation;
    const Eigen::Vector3d rate(0, 0, 0.4363);
    for (std::size_t i = 20; i < 30; ++i) {
      Frame black = flight.frames[i];
      black.grey = cv::Mat(black.grey.size(), CV_8UC1, cv::Scalar(static_cast<double>(i - 20)));
      SensorReadings readings;
      readings.mean_angular_rate_in_body_rad_s = rate + bias;
      e = estimator.step(black, readings);
      EXPECT_NE(e.verdict, Verdict::ok);
    }
    const double error_rad =
        angle_between_rad(e.world_from_body.rotation, before * so3_exp(rate * 0.4));
    const double sigma_rad = std::sqrt(e.pose_covariance(5, 5));
    EXPECT_LT(error_rad, has_images_before ? 0.02 : 0.15);
    EXPECT_LT(sigma_rad, has_images_before ? 0.02 : 0.15);
    EXPECT_LT(error_rad, 4 * sigma_rad);
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, Sensors, testing::Values(Mode::paper, Mode::recommended),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

}  // namespace
}  // namespace stillkite
