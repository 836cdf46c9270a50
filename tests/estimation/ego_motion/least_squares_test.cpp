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

EgoMotion solve(const test::FlowScene& scene, const std::vector<FlowVector>& vectors,
                const LeastSquaresConfig& config = {},
                const std::optional<TwistPrior>& prior = {}) {
  EgoMotionSolver solver(scene.camera, config);
  return solver.solve(vectors, scene.ground(), scene.dt_s, prior);
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

TEST(LeastSquares, IsExactOnNoiseFreeFlow) {
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

TEST(LeastSquares, IsExactAtAnyAttitude) {
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

TEST(LeastSquares, MirroredImageGivesMirroredTwist) {
  test::FlowScene scene;
  scene.camera.distortion = DistortionModel::none;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(5);
  test::add_noise(vectors, 0.3, random);
  GroundPlane ground = scene.ground();
  EgoMotionSolver solver(scene.camera, {});
  const EgoMotion motion = solver.solve(vectors, ground, scene.dt_s);

  Camera mirrored_camera = scene.camera;
  mirrored_camera.centre_x_px = scene.camera.width_px - 1 - scene.camera.centre_x_px;
  for (FlowVector& vector : vectors) {
    vector.pixel.x() = static_cast<float>(scene.camera.width_px - 1) - vector.pixel.x();
    vector.flow_px.x() *= -1;
  }
  ground.normal_in_camera.x() *= -1;
  EgoMotionSolver mirrored_solver(mirrored_camera, {});
  const EgoMotion mirrored = mirrored_solver.solve(vectors, ground, scene.dt_s);

  const Vector6d signs{-1, 1, 1, 1, -1, -1};  // reflection across x: polar and axial vector
  const Twist expected = Twist::from_vector(signs.cwiseProduct(motion.twist.vector()));
  expect_twist(mirrored.twist, expected, 1e-6);
}

TEST(LeastSquares, ReversedFlowGivesReversedTwist) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(6);
  test::add_noise(vectors, 0.3, random);
  const EgoMotion forward = solve(scene, vectors);
  for (FlowVector& vector : vectors) vector.flow_px *= -1;
  const EgoMotion backward = solve(scene, vectors);
  expect_twist(backward.twist, Twist::from_vector(-forward.twist.vector()), 1e-9);
}

TEST(LeastSquares, VelocityScalesWithHeight) {
  test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(7);
  test::add_noise(vectors, 0.3, random);
  const EgoMotion low = solve(scene, vectors);
  scene.world_from_camera.translation.z() *= 7;
  const EgoMotion high = solve(scene, vectors);
  expect_twist(high.twist, {7 * low.twist.velocity_m_s, low.twist.angular_rate_rad_s}, 1e-8);
  EXPECT_NEAR(high.covariance(0, 0) / low.covariance(0, 0), 49, 1e-6);
  EXPECT_NEAR(high.condition / low.condition, 1, 1e-6);
}

TEST(LeastSquares, UsesOnlyNormalFlowOfEdges) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(8);
  std::uniform_real_distribution<float> angle(0, 3.14159F);
  std::normal_distribution<float> normal;
  for (FlowVector& vector : vectors) {  // edges: flow along the edge is arbitrary
    const float a = angle(random);
    const Eigen::Vector2f across(std::cos(a), std::sin(a));
    vector.information_xx = across.x() * across.x();
    vector.information_xy = across.x() * across.y();
    vector.information_yy = across.y() * across.y();
    vector.flow_px += 5 * normal(random) * Eigen::Vector2f(-across.y(), across.x());
  }
  for (const Weighting weighting : {Weighting::information, Weighting::robust}) {
    const EgoMotion motion = solve(scene, vectors, {.weighting = weighting});
    ASSERT_EQ(motion.verdict, Verdict::ok);
    expect_twist(motion.twist, scene.twist, 2e-5);
    EXPECT_EQ(motion.inlier_ratio, 1);
  }
}

TEST(LeastSquares, ToleratesThirtyPercentOutliers) {
  const test::FlowScene scene;
  for (const RobustKernel kernel :
       {RobustKernel::huber, RobustKernel::tukey, RobustKernel::geman_mcclure}) {
    std::vector<FlowVector> vectors = scene.flow();
    std::mt19937 random(9);
    test::add_noise(vectors, 0.1, random);
    std::uniform_real_distribution<float> uniform(-15, 15);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      if (i % 10 < 3) vectors[i].flow_px += Eigen::Vector2f(uniform(random), uniform(random));
    }
    const EgoMotion robust = solve(scene, vectors, {.kernel = kernel});
    ASSERT_EQ(robust.verdict, Verdict::ok);
    EXPECT_NEAR(robust.inlier_ratio, 0.7, 0.03);
    expect_twist(robust.twist, scene.twist, kernel == RobustKernel::huber ? 0.1 : 0.03);
    const Vector6d error = robust.twist.vector() - scene.twist.vector();
    constexpr double kChiSquare999 = 22.5;  // six degrees of freedom
    EXPECT_LT(error.dot(robust.covariance.ldlt().solve(error)), kChiSquare999);
    const EgoMotion plain =
        solve(scene, vectors, {.weighting = Weighting::plain, .min_inlier_ratio = 0});
    EXPECT_GT((plain.twist.velocity_m_s - scene.twist.velocity_m_s).norm(), 0.15);
  }
}

TEST(LeastSquares, RejectsMovingVehicle) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(10);
  test::add_noise(vectors, 0.1, random);
  const EgoMotion clean = solve(scene, vectors);
  for (FlowVector& vector : vectors) {  // vehicle on 4 % of the image
    if ((vector.pixel - Eigen::Vector2f(420, 150)).cwiseAbs().maxCoeff() < 55) {
      vector.flow_px += Eigen::Vector2f(6, 2);
    }
  }
  expect_twist(solve(scene, vectors).twist, clean.twist, 0.01);
}

TEST(LeastSquares, GyroPriorReducesVelocityCovariance) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  std::mt19937 random(11);
  test::add_noise(vectors, 0.4, random);
  TwistPrior gyro{.mean = {Eigen::Vector3d::Zero(), scene.twist.angular_rate_rad_s}};
  gyro.information.diagonal().tail<3>().setConstant(1 / (1e-4 * 1e-4));
  for (const Weighting weighting : kWeightings) {
    const EgoMotion without_prior = solve(scene, vectors, {.weighting = weighting});
    const EgoMotion with_prior = solve(scene, vectors, {.weighting = weighting}, gyro);
    ASSERT_EQ(with_prior.verdict, Verdict::ok);
    EXPECT_LT((with_prior.twist.angular_rate_rad_s - scene.twist.angular_rate_rad_s).norm(), 3e-4);
    EXPECT_LT(with_prior.covariance(0, 0), 0.5 * without_prior.covariance(0, 0));
  }
}

TEST(LeastSquares, RejectsDegenerateInputs) {
  test::FlowScene scene;
  const std::vector<FlowVector> good = scene.flow();
  EXPECT_EQ(solve(scene, {}).verdict, Verdict::too_little_texture);

  std::vector<FlowVector> textureless = good;
  for (FlowVector& v : textureless) v.information_xx = v.information_xy = v.information_yy = 0;
  EXPECT_EQ(solve(scene, textureless).verdict, Verdict::too_little_texture);

  std::vector<FlowVector> invalid = good;
  for (FlowVector& v : invalid) v.flow_px.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(solve(scene, invalid).verdict, Verdict::too_little_texture);
  for (FlowVector& v : invalid) v.pixel.x() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(solve(scene, invalid).verdict, Verdict::too_little_texture);

  const std::vector<FlowVector> coincident(100, good[500]);
  EXPECT_EQ(solve(scene, coincident).verdict, Verdict::ill_conditioned);

  std::vector<FlowVector> edges = good;  // furrows: flow along them is unobservable
  for (FlowVector& v : edges) v.information_xx = 0;
  for (FlowVector& v : edges) v.pixel.y() = 240;
  const EgoMotion furrows = solve(scene, edges);
  EXPECT_EQ(furrows.verdict, Verdict::ill_conditioned);
  EXPECT_FALSE(name_direction(furrows.weakest).empty());

  std::vector<FlowVector> water = good;
  std::mt19937 random(12);
  std::uniform_real_distribution<float> uniform(-8, 8);
  for (FlowVector& v : water) v.flow_px = {uniform(random), uniform(random)};
  EXPECT_EQ(solve(scene, water).verdict, Verdict::too_few_inliers);

  scene.world_from_camera.rotation = Eigen::Quaterniond::Identity();  // camera points straight up
  EXPECT_EQ(solve(scene, good).verdict, Verdict::horizon);

  for (const auto& vectors : {textureless, invalid, coincident, edges, water}) {
    for (const Weighting weighting : kWeightings) {
      EXPECT_TRUE(is_finite(solve(scene, vectors, {.weighting = weighting})));
    }
  }
}

TEST(LeastSquares, ZeroFlowGivesZeroTwist) {
  const test::FlowScene scene;
  std::vector<FlowVector> vectors = scene.flow();
  for (FlowVector& vector : vectors) vector.flow_px.setZero();
  const EgoMotion motion = solve(scene, vectors);
  EXPECT_EQ(motion.verdict, Verdict::ok);
  EXPECT_EQ(motion.twist.vector().norm(), 0);
}

TEST(LeastSquares, NamesDominantComponents) {
  EXPECT_EQ(name_direction({0.7, 0, 0, 0, 0.71, 0.01}), "w_y, v_x");
  EXPECT_EQ(name_direction({0, 0, -1, 0, 0, 0}), "v_z");
  EXPECT_EQ(name_direction(Vector6d::Zero()), "");
}

}  // namespace
}  // namespace stillkite
