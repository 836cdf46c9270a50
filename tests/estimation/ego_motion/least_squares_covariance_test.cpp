#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <random>

#include "estimation/ego_motion/least_squares.hpp"
#include "tests/estimation/ego_motion/flow_scene.hpp"

namespace stillkite {
namespace {

constexpr int kRuns = 400;

// Mean NEES over seeded runs; 6 for a consistent covariance.
template <typename Disturb>
double mean_nees(const test::FlowScene& scene, const LeastSquaresConfig& config,
                 const Disturb& disturb) {
  EgoMotionSolver solver(scene.camera, config);
  const std::vector<FlowVector> exact = scene.flow();
  double sum = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937 random(static_cast<unsigned>(run));
    std::vector<FlowVector> vectors = exact;
    disturb(vectors, random);
    const EgoMotion motion = solver.solve(vectors, scene.ground(), scene.dt_s);
    EXPECT_EQ(motion.verdict, Verdict::ok);
    const Vector6d error = motion.twist.vector() - scene.twist.vector();
    sum += error.dot(motion.covariance.ldlt().solve(error));
  }
  return sum / kRuns;
}

// 99 % band of the mean of kRuns chi-square variables with 6 degrees of freedom.
const double kBand = 2.576 * std::sqrt(2.0 * 6 / kRuns);

void white(std::vector<FlowVector>& vectors, std::mt19937& random) {
  std::uniform_real_distribution<float> texture(0.2F, 4.0F);
  for (FlowVector& v : vectors) {
    v.information_xx = texture(random);
    v.information_yy = texture(random);
    v.information_xy = 0.5F * std::sqrt(v.information_xx * v.information_yy);
  }
  test::add_noise(vectors, 0.2, random);
}

// Flow errors correlated over about 30 px, as in compressed video.
void correlated(std::vector<FlowVector>& vectors, std::mt19937& random) {
  constexpr float kPatch_px = 30;
  std::normal_distribution<float> normal(0, 0.2F);
  std::array<std::array<Eigen::Vector2f, 22>, 22> patch_errors;
  for (auto& row : patch_errors) {
    for (Eigen::Vector2f& error : row) error = {normal(random), normal(random)};
  }
  for (FlowVector& v : vectors) {
    const Eigen::Vector2f patch = v.pixel / kPatch_px;
    v.flow_px +=
        patch_errors[static_cast<std::size_t>(patch.y())][static_cast<std::size_t>(patch.x())];
  }
}

TEST(LeastSquaresCovariance, ResidualFormIsConsistentForIndependentErrors) {
  const test::FlowScene scene;
  for (const Weighting weighting : {Weighting::information, Weighting::robust}) {
    const LeastSquaresConfig config{.weighting = weighting,
                                    .covariance = CovarianceForm::residuals};
    EXPECT_NEAR(mean_nees(scene, config, white), 6, kBand);
  }
}

TEST(LeastSquaresCovariance, ResidualFormIsConsistentForPlainWeighting) {
  const test::FlowScene scene;
  const LeastSquaresConfig config{.weighting = Weighting::plain,
                                  .covariance = CovarianceForm::residuals};
  const auto unit_noise = [](std::vector<FlowVector>& vectors, std::mt19937& random) {
    test::add_noise(vectors, 0.2, random);
  };
  EXPECT_NEAR(mean_nees(scene, config, unit_noise), 6, kBand);
}

TEST(LeastSquaresCovariance, JackknifeIsConsistentForIndependentErrors) {
  EXPECT_NEAR(mean_nees(test::FlowScene{}, {.covariance = CovarianceForm::cells}, white), 6, kBand);
}

TEST(LeastSquaresCovariance, JackknifeIsNearlyConsistentForCorrelatedErrors) {
  const test::FlowScene scene;
  // errors of 30 px extend across the borders of the 100 px cells
  EXPECT_NEAR(mean_nees(scene, {.covariance = CovarianceForm::cells}, correlated), 7, 1);
  EXPECT_GT(mean_nees(scene, {.covariance = CovarianceForm::residuals}, correlated), 15);
}

}  // namespace
}  // namespace stillkite
