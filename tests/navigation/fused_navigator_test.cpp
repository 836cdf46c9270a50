#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite {
namespace {

constexpr double kFramesPerSecond = 30;
constexpr int kReadingsPerFrame = 7;
const RigidTransform kForwardMount = camera_raised_forward(75);

/// A level body that sways across the view and turns a little; at rest at time 0.
struct Sway {
  static constexpr double kReach_m = 0.25;
  static constexpr double kRate_rad_s = 2.0;
  static constexpr double kTurn_rad = 0.05;

  [[nodiscard]] static RigidTransform pose(double t_s) {
    const double phase = kRate_rad_s * t_s;
    const double yaw_rad = kTurn_rad * (1 - std::cos(phase));
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d(0, kReach_m * (1 - std::cos(phase)), 3)};
  }
  [[nodiscard]] static Eigen::Vector3d velocity_in_world_m_s(double t_s) {
    return {0, kReach_m * kRate_rad_s * std::sin(kRate_rad_s * t_s), 0};
  }
  /// About the vertical, over the frame's interval that ends then.
  [[nodiscard]] static double mean_rate_rad_s(double t_s) {
    const double before_s = t_s - 1 / kFramesPerSecond;
    return kTurn_rad * (std::cos(kRate_rad_s * before_s) - std::cos(kRate_rad_s * t_s)) *
           kFramesPerSecond;
  }
  [[nodiscard]] static InertialReading reading(double t_s) {
    const double phase = kRate_rad_s * t_s;
    const Eigen::Vector3d force(0, kReach_m * kRate_rad_s * kRate_rad_s * std::cos(phase), 9.80665);
    return {.stamp = from_seconds(t_s),
            .angular_rate_in_body_rad_s = {0, 0, kTurn_rad * kRate_rad_s * std::sin(phase)},
            .specific_force_in_body_m_s2 = pose(t_s).rotation.conjugate() * force};
  }
};

/// The images of the sway, with the readings of the IMU before each.
class FusedFlight {
 public:
  explicit FusedFlight(double known_height_m = 3, Policy policy = Policy::fused,
                       ScaleSource scale = ScaleSource::initial_height,
                       const Camera& told = small_camera())
      : scene_(make_room(5)),
        renderer_(small_camera(), 2),
        navigator_(told, kForwardMount, {},
                   {.world_from_body = {Eigen::Quaterniond::Identity(), {0, 0, known_height_m}},
                    .scale = scale},
                   {.policy = policy}) {}

  NavigationEstimate step(const cv::Mat& image, const InertialReading& bad = {}) {
    SensorReadings readings;
    if (!bad.specific_force_in_body_m_s2.isZero()) readings.inertial.push_back(bad);
    readings.attitude = Sway::pose(time_s()).rotation;
    for (int i = 1; index_ > 0 && i <= kReadingsPerFrame; ++i) {
      const double since = (i - 0.5) / kReadingsPerFrame;
      InertialReading reading = Sway::reading((index_ - 1 + since) / kFramesPerSecond);
      reading.stamp = from_seconds((index_ - 1 + static_cast<double>(i) / kReadingsPerFrame) /
                                   kFramesPerSecond);
      readings.inertial.push_back(reading);
    }
    const NavigationEstimate estimate = navigator_.step(
        {.stamp = from_seconds(time_s()), .index = index_, .grey = image}, readings);
    ++index_;
    return estimate;
  }
  NavigationEstimate step() { return step(image()); }
  /// Of the next frame.
  [[nodiscard]] cv::Mat image() const {
    return develop(renderer_.render(scene_, Sway::pose(time_s()) * kForwardMount),
                   {.noise_grey = 1.5}, static_cast<std::uint64_t>(index_));
  }
  /// Of the next frame.
  [[nodiscard]] double time_s() const { return index_ / kFramesPerSecond; }

 private:
  PatchScene scene_;
  PatchRenderer renderer_;
  Navigator navigator_;
  int index_ = 0;
};

Eigen::Vector3d way_error_m(const NavigationEstimate& first, const NavigationEstimate& now) {
  const double t_s = to_seconds(now.stamp);
  return (now.world_from_body.translation - first.world_from_body.translation) -
         (Sway::pose(t_s).translation - Sway::pose(0).translation);
}

// A room is no flat ground: neither estimator alone knows the way in metres here.
TEST(FusedNavigator, KnowsWayAndVelocityInMetresInARoom) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  EXPECT_EQ(first.verdict, Verdict::first_frame);
  for (int i = 1; i <= 120; ++i) {
    const double t_s = flight.time_s();
    const NavigationEstimate estimate = flight.step();
    ASSERT_EQ(estimate.verdict, Verdict::ok) << "frame " << i;
    EXPECT_EQ(estimate.source, EstimateSource::fused);
    if (i == 1) {
      EXPECT_EQ(estimate.scale, ScaleSource::none) << "nothing has told metres yet";
    }
    if (i < 60) continue;  // within two seconds the depths and the scale have shown
    EXPECT_EQ(estimate.scale, ScaleSource::initial_height);
    EXPECT_LT(way_error_m(first, estimate).norm(), 0.03) << "frame " << i;
    EXPECT_LT((estimate.velocity_in_world_m_s - Sway::velocity_in_world_m_s(t_s)).norm(), 0.05);
    EXPECT_LT(angle_between_rad(estimate.world_from_body.rotation, Sway::pose(t_s).rotation),
              0.2 * kDegree);
  }
}

TEST(FusedNavigator, CoversItsErrors) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  int outside = 0;
  for (int i = 1; i <= 120; ++i) {
    const double t_s = flight.time_s();
    const NavigationEstimate estimate = flight.step();
    const Eigen::Vector3d rate_error =
        kForwardMount.rotation * estimate.twist_in_camera.angular_rate_rad_s -
        Eigen::Vector3d(0, 0, Sway::mean_rate_rad_s(t_s));
    EXPECT_LT(rate_error.norm(),
              3 * std::sqrt(estimate.twist_covariance.bottomRightCorner<3, 3>().trace()));
    const Eigen::Vector3d error = way_error_m(first, estimate);
    const Eigen::Vector3d sigma = estimate.pose_covariance.diagonal().head<3>().cwiseSqrt();
    outside += (error.array().abs() > 3 * sigma.array() + 1e-3).any() ? 1 : 0;
  }
  EXPECT_LE(outside, 6);
}

// By what features are off from their epipolar lines. Of the first frames, before both have gone
// through their starts, nothing follows.
TEST(FusedNavigator, IsLessSureThroughALensThatIsNotAsTold) {
  Camera wrong = small_camera();
  wrong.coefficients[0] += 0.05;
  FusedFlight right;
  FusedFlight astray(3, Policy::fused, ScaleSource::initial_height, wrong);
  const auto turn_variance = [](const NavigationEstimate& estimate) {
    return estimate.pose_covariance.diagonal().tail<3>().sum();
  };
  for (int i = 0; i <= 60; ++i) {
    const double known = turn_variance(right.step());
    const double vague = turn_variance(astray.step());
    if (i < 45) continue;
    EXPECT_GT(vague, 1.5 * known) << "frame " << i;
  }
}

// Frames that show nothing: a verdict, a growing covariance, the IMU's way; then as before. The
// scale is well known by then: what the way is uncertain by for its sake shrinks with the way.
TEST(FusedNavigator, GoesOnByInertiaInTheDark) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  NavigationEstimate before;
  for (int i = 1; i <= 120; ++i) before = flight.step();
  NavigationEstimate dark;
  for (int i = 0; i < 15; ++i) {
    dark = flight.step(cv::Mat::zeros(240, 400, CV_8UC1));
    EXPECT_NE(dark.verdict, Verdict::ok);
  }
  EXPECT_GT(dark.pose_covariance(1, 1), before.pose_covariance(1, 1));
  EXPECT_LT(way_error_m(first, dark).norm(), 0.06);
  NavigationEstimate after;
  for (int i = 0; i < 20; ++i) after = flight.step();
  EXPECT_EQ(after.verdict, Verdict::ok);
  EXPECT_LT(way_error_m(first, after).norm(), 0.03);
}

// A reading that is no number is none; the others carry on.
TEST(FusedNavigator, LeavesOutReadingsThatAreNoNumbers) {
  FusedFlight flight;
  const NavigationEstimate first = flight.step();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  NavigationEstimate estimate;
  for (int i = 1; i <= 90; ++i) {
    const InertialReading bad{.stamp = from_seconds(flight.time_s() - 0.02),
                              .angular_rate_in_body_rad_s = {nan, 0, 0},
                              .specific_force_in_body_m_s2 = {0, nan, 0}};
    estimate = flight.step(flight.image(), bad);
    ASSERT_TRUE(estimate.world_from_body.translation.allFinite());
    ASSERT_TRUE(estimate.twist_covariance.allFinite());
  }
  EXPECT_EQ(estimate.verdict, Verdict::ok);
  EXPECT_LT(way_error_m(first, estimate).norm(), 0.03);
}

// The accelerometer measures metres where nothing else does: until it has, there are none.
TEST(FusedNavigator, KnowsMetresByTheImuWhereNoHeightIsGiven) {
  FusedFlight flight(1, Policy::fused, ScaleSource::none);
  const NavigationEstimate first = flight.step();
  EXPECT_EQ(flight.step().scale, ScaleSource::none);
  NavigationEstimate estimate;
  for (int i = 2; i <= 360; ++i) estimate = flight.step();
  EXPECT_EQ(estimate.scale, ScaleSource::imu);
  const double error_m = way_error_m(first, estimate).norm();
  EXPECT_LT(error_m, 0.05);
  EXPECT_LT(error_m, 3 * std::sqrt(estimate.pose_covariance.topLeftCorner<3, 3>().trace()));
  EXPECT_EQ(estimate.reference->motion.scale, ScaleSource::imu);
}

TEST(FusedNavigator, FeaturesThatAreNumberedAnewAreAnError) {
  NavigatorConfig config;
  config.reference.association = Association::matching;
  EXPECT_THROW((Navigator(small_camera(), kForwardMount, config, {.world_from_body = Sway::pose(0)},
                          {.policy = Policy::fused})),
               InputError);
}

TEST(FusedNavigator, MoreLandmarksNeededThanThereAreIsAnError) {
  NavigatorConfig config;
  config.fusion.landmarks = 8;
  EXPECT_THROW((Navigator(small_camera(), kForwardMount, config, {.world_from_body = Sway::pose(0)},
                          {.policy = Policy::fused})),
               InputError);
}

}  // namespace
}  // namespace stillkite
