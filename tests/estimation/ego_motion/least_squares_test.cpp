#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "estimation/ego_motion/least_squares.hpp"
#include "tests/estimation/ego_motion/flow_scene.hpp"

namespace stillkite {
namespace {

constexpr std::array kWeightings{Weighting::plain, Weighting::information, Weighting::robust};

EgoMotion solve(const test::FlowScene& scene, const std::vector<FlowWindow>& windows,
                const LeastSquaresConfig& config = {},
                const std::optional<TwistPrior>& prior = {}) {
  EgoMotionSolver solver(scene.camera, config);
  return solver.solve(windows, scene.ground(), scene.dt_s, prior);
}

void expect_twist(const Twist& actual, const Twist& expected, double tolerance) {
  EXPECT_LT((actual.velocity_m_s - expected.velocity_m_s).norm(), tolerance)
      << actual.velocity_m_s.transpose() << " not " << expected.velocity_m_s.transpose();
  EXPECT_LT((actual.angular_rate_rad_s - expected.angular_rate_rad_s).norm(), 0.1 * tolerance)
      << actual.angular_rate_rad_s.transpose() << " not "
      << expected.angular_rate_rad_s.transpose();
}

bool is_finite(const EgoMotion& motion) {
  return motion.twist.vector().allFinite() && motion.covariance.allFinite() &&
         std::isfinite(motion.inlier_ratio) && std::isfinite(motion.residual_px) &&
         !std::isnan(motion.condition) && motion.weakest.allFinite();
}

TEST(LeastSquares, ExactOnExactFlow) {
  const test::FlowScene scene;
  for (const Weighting weighting : kWeightings) {
    const EgoMotion motion = solve(scene, scene.flow(), {.weighting = weighting});
    ASSERT_EQ(motion.verdict, Verdict::ok);
    expect_twist(motion.twist, scene.twist, 1e-6);
    EXPECT_EQ(motion.inlier_ratio, 1);
    EXPECT_LT(motion.residual_px, 1e-6);
    EXPECT_GE(motion.condition, 1);
    EXPECT_LT(motion.covariance.diagonal().maxCoeff(), 1e-12);
  }
}

TEST(LeastSquares, ExactAtAnyAttitudeWithTheGroundInView) {
  std::mt19937 random(4);
  test::FlowScene scene;
  int solved = 0;
  for (int trial = 0; trial < 60; ++trial) {
    scene.world_from_camera.rotation = so3_exp(test::random_vector(random, 3.0));
    scene.twist = {test::random_vector(random, 5), test::random_vector(random, 0.5)};
    const EgoMotion motion = solve(scene, scene.flow());
    EXPECT_TRUE(is_finite(motion));
    if (motion.verdict != Verdict::ok) continue;
    ++solved;
    expect_twist(motion.twist, scene.twist, 1e-4);
  }
  EXPECT_GT(solved, 15);
}

TEST(LeastSquares, MirroredImageGivesMirroredMotion) {
  test::FlowScene scene;
  scene.camera.distortion = DistortionModel::none;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(5);
  test::add_noise(windows, 0.3, random);
  GroundPlane ground = scene.ground();
  EgoMotionSolver solver(scene.camera, {});
  const EgoMotion motion = solver.solve(windows, ground, scene.dt_s);

  Camera mirrored_camera = scene.camera;
  mirrored_camera.centre_x_px = scene.camera.width_px - 1 - scene.camera.centre_x_px;
  for (FlowWindow& window : windows) {
    window.pixel.x() = static_cast<float>(scene.camera.width_px - 1) - window.pixel.x();
    window.flow_px.x() *= -1;
  }
  ground.normal_in_camera.x() *= -1;
  EgoMotionSolver mirrored_solver(mirrored_camera, {});
  const EgoMotion mirrored = mirrored_solver.solve(windows, ground, scene.dt_s);

  const Vector6d signs{-1, 1, 1, 1, -1, -1};  // a polar and an axial vector in a mirror across x
  const Twist expected = Twist::from_vector(signs.cwiseProduct(motion.twist.vector()));
  expect_twist(mirrored.twist, expected, 1e-6);
}

TEST(LeastSquares, ReversedFlowGivesReversedMotion) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(6);
  test::add_noise(windows, 0.3, random);
  const EgoMotion forward = solve(scene, windows);
  for (FlowWindow& window : windows) window.flow_px *= -1;
  const EgoMotion backward = solve(scene, windows);
  expect_twist(backward.twist, Twist::from_vector(-forward.twist.vector()), 1e-9);
}

TEST(LeastSquares, HeightIsPureScaleOfTheVelocity) {
  test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(7);
  test::add_noise(windows, 0.3, random);
  const EgoMotion low = solve(scene, windows);
  scene.world_from_camera.translation.z() *= 7;
  const EgoMotion high = solve(scene, windows);
  expect_twist(high.twist, {7 * low.twist.velocity_m_s, low.twist.angular_rate_rad_s}, 1e-8);
  EXPECT_NEAR(high.covariance(0, 0) / low.covariance(0, 0), 49, 1e-6);
  EXPECT_NEAR(high.condition / low.condition, 1, 1e-6);
}

TEST(LeastSquares, EdgesCountAlongTheirNormalOnly) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(8);
  std::uniform_real_distribution<float> angle(0, 3.14159F);
  std::normal_distribution<float> normal;
  for (FlowWindow& window : windows) {  // every window an edge, its flow along the edge invented
    const float a = angle(random);
    const Eigen::Vector2f across(std::cos(a), std::sin(a));
    window.information_xx = across.x() * across.x();
    window.information_xy = across.x() * across.y();
    window.information_yy = across.y() * across.y();
    window.flow_px += 5 * normal(random) * Eigen::Vector2f(-across.y(), across.x());
  }
  for (const Weighting weighting : {Weighting::information, Weighting::robust}) {
    const EgoMotion motion = solve(scene, windows, {.weighting = weighting});
    ASSERT_EQ(motion.verdict, Verdict::ok);
    expect_twist(motion.twist, scene.twist, 2e-5);
    EXPECT_EQ(motion.inlier_ratio, 1);
  }
}

TEST(LeastSquares, ThirtyPercentOutliersChangeLittle) {
  const test::FlowScene scene;
  for (const RobustKernel kernel :
       {RobustKernel::huber, RobustKernel::tukey, RobustKernel::geman_mcclure}) {
    std::vector<FlowWindow> windows = scene.flow();
    std::mt19937 random(9);
    test::add_noise(windows, 0.1, random);
    std::uniform_real_distribution<float> anywhere(-15, 15);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (i % 10 < 3) windows[i].flow_px += Eigen::Vector2f(anywhere(random), anywhere(random));
    }
    const EgoMotion robust = solve(scene, windows, {.kernel = kernel});
    ASSERT_EQ(robust.verdict, Verdict::ok);
    EXPECT_NEAR(robust.inlier_ratio, 0.7, 0.03);
    expect_twist(robust.twist, scene.twist, kernel == RobustKernel::huber ? 0.1 : 0.03);
    const Vector6d error = robust.twist.vector() - scene.twist.vector();
    constexpr double kChiSquare999 = 22.5;  // six degrees of freedom
    EXPECT_LT(error.dot(robust.covariance.ldlt().solve(error)), kChiSquare999);
    const EgoMotion plain =
        solve(scene, windows, {.weighting = Weighting::plain, .min_inlier_ratio = 0});
    EXPECT_GT((plain.twist.velocity_m_s - scene.twist.velocity_m_s).norm(), 0.15);
  }
}

TEST(LeastSquares, VehicleDoesNotPull) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(10);
  test::add_noise(windows, 0.1, random);
  const EgoMotion clean = solve(scene, windows);
  for (FlowWindow& window : windows) {  // 4 % of the image moves as one
    if ((window.pixel - Eigen::Vector2f(420, 150)).cwiseAbs().maxCoeff() < 55) {
      window.flow_px += Eigen::Vector2f(6, 2);
    }
  }
  expect_twist(solve(scene, windows).twist, clean.twist, 0.01);
}

TEST(LeastSquares, PriorHelpsWhereTheFlowIsBlind) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  std::mt19937 random(11);
  test::add_noise(windows, 0.4, random);
  TwistPrior gyro{.mean = {Eigen::Vector3d::Zero(), scene.twist.angular_rate_rad_s}};
  gyro.information.diagonal().tail<3>().setConstant(1 / (1e-4 * 1e-4));
  for (const Weighting weighting : kWeightings) {
    const EgoMotion free = solve(scene, windows, {.weighting = weighting});
    const EgoMotion held = solve(scene, windows, {.weighting = weighting}, gyro);
    ASSERT_EQ(held.verdict, Verdict::ok);
    EXPECT_LT((held.twist.angular_rate_rad_s - scene.twist.angular_rate_rad_s).norm(), 3e-4);
    EXPECT_LT(held.covariance(0, 0), 0.5 * free.covariance(0, 0));
  }
}

TEST(LeastSquares, DegenerateInputsGetAVerdict) {
  test::FlowScene scene;
  const std::vector<FlowWindow> good = scene.flow();
  EXPECT_EQ(solve(scene, {}).verdict, Verdict::too_little_texture);

  std::vector<FlowWindow> bare = good;
  for (FlowWindow& w : bare) w.information_xx = w.information_xy = w.information_yy = 0;
  EXPECT_EQ(solve(scene, bare).verdict, Verdict::too_little_texture);

  std::vector<FlowWindow> broken = good;
  for (FlowWindow& w : broken) w.flow_px.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(solve(scene, broken).verdict, Verdict::too_little_texture);
  for (FlowWindow& w : broken) w.pixel.x() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(solve(scene, broken).verdict, Verdict::too_little_texture);

  const std::vector<FlowWindow> one_place(100, good[500]);
  EXPECT_EQ(solve(scene, one_place).verdict, Verdict::ill_conditioned);

  std::vector<FlowWindow> edges = good;  // a field of furrows: nothing is seen along them
  for (FlowWindow& w : edges) w.information_xx = 0;
  for (FlowWindow& w : edges) w.pixel.y() = 240;
  const EgoMotion furrows = solve(scene, edges);
  EXPECT_EQ(furrows.verdict, Verdict::ill_conditioned);
  EXPECT_FALSE(name_direction(furrows.weakest).empty());

  std::vector<FlowWindow> water = good;
  std::mt19937 random(12);
  std::uniform_real_distribution<float> anywhere(-8, 8);
  for (FlowWindow& w : water) w.flow_px = {anywhere(random), anywhere(random)};
  EXPECT_EQ(solve(scene, water).verdict, Verdict::too_few_inliers);

  scene.world_from_camera.rotation = Eigen::Quaterniond::Identity();  // looks straight up
  EXPECT_EQ(solve(scene, good).verdict, Verdict::horizon);

  for (const auto& windows : {bare, broken, one_place, edges, water}) {
    for (const Weighting weighting : kWeightings) {
      EXPECT_TRUE(is_finite(solve(scene, windows, {.weighting = weighting})));
    }
  }
}

TEST(LeastSquares, StillImageIsAtRest) {
  const test::FlowScene scene;
  std::vector<FlowWindow> windows = scene.flow();
  for (FlowWindow& window : windows) window.flow_px.setZero();
  const EgoMotion motion = solve(scene, windows);
  EXPECT_EQ(motion.verdict, Verdict::ok);
  EXPECT_EQ(motion.twist.vector().norm(), 0);
}

TEST(LeastSquares, NamesTheWeakestDirection) {
  EXPECT_EQ(name_direction({0.7, 0, 0, 0, 0.71, 0.01}), "w_y, v_x");
  EXPECT_EQ(name_direction({0, 0, -1, 0, 0, 0}), "v_z");
  EXPECT_EQ(name_direction(Vector6d::Zero()), "");
}

}  // namespace
}  // namespace stillkite
