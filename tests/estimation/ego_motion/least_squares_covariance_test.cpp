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

// Mean normalised estimation error squared over seeded runs; 6 where the covariance is honest.
template <typename Disturb>
double mean_nees(const test::FlowScene& scene, const LeastSquaresConfig& config,
                 const Disturb& disturb) {
  EgoMotionSolver solver(scene.camera, config);
  const std::vector<FlowWindow> exact = scene.flow();
  double sum = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937 random(static_cast<unsigned>(run));
    std::vector<FlowWindow> windows = exact;
    disturb(windows, random);
    const EgoMotion motion = solver.solve(windows, scene.ground(), scene.dt_s);
    EXPECT_EQ(motion.verdict, Verdict::ok);
    const Vector6d error = motion.twist.vector() - scene.twist.vector();
    sum += error.dot(motion.covariance.ldlt().solve(error));
  }
  return sum / kRuns;
}

// 99 % of the mean of kRuns chi-square variables with 6 degrees of freedom lies within this.
const double kBand = 2.576 * std::sqrt(2.0 * 6 / kRuns);

void white(std::vector<FlowWindow>& windows, std::mt19937& random) {
  std::uniform_real_distribution<float> texture(0.2F, 4.0F);
  for (FlowWindow& w : windows) {
    w.information_xx = texture(random);
    w.information_yy = texture(random);
    w.information_xy = 0.5F * std::sqrt(w.information_xx * w.information_yy);
  }
  test::add_noise(windows, 0.2, random);
}

// Errors that neighbours share over about 30 px, as compressed video makes them.
void patches(std::vector<FlowWindow>& windows, std::mt19937& random) {
  constexpr float kPatch_px = 30;
  std::normal_distribution<float> normal(0, 0.2F);
  std::array<std::array<Eigen::Vector2f, 22>, 22> shared;
  for (auto& row : shared) {
    for (Eigen::Vector2f& v : row) v = {normal(random), normal(random)};
  }
  for (FlowWindow& w : windows) {
    const Eigen::Vector2f patch = w.pixel / kPatch_px;
    w.flow_px += shared[static_cast<std::size_t>(patch.y())][static_cast<std::size_t>(patch.x())];
  }
}

TEST(LeastSquaresCovariance, HonestOnIndependentErrors) {
  const test::FlowScene scene;
  for (const Weighting weighting : {Weighting::information, Weighting::robust}) {
    const LeastSquaresConfig config{.weighting = weighting,
                                    .covariance = CovarianceForm::residuals};
    EXPECT_NEAR(mean_nees(scene, config, white), 6, kBand);
  }
}

TEST(LeastSquaresCovariance, HonestInThePapersPlainForm) {
  const test::FlowScene scene;
  const LeastSquaresConfig config{.weighting = Weighting::plain,
                                  .covariance = CovarianceForm::residuals};
  const auto unit_noise = [](std::vector<FlowWindow>& windows, std::mt19937& random) {
    test::add_noise(windows, 0.2, random);
  };
  EXPECT_NEAR(mean_nees(scene, config, unit_noise), 6, kBand);
}

TEST(LeastSquaresCovariance, ByCellsHonestOnIndependentErrorsToo) {
  EXPECT_NEAR(mean_nees(test::FlowScene{}, {.covariance = CovarianceForm::cells}, white), 6, kBand);
}

TEST(LeastSquaresCovariance, ByCellsNearlyHonestWhereNeighboursErrTogether) {
  const test::FlowScene scene;
  // cells of 100 px share the patches at their borders: what is left of the error's correlation
  EXPECT_NEAR(mean_nees(scene, {.covariance = CovarianceForm::cells}, patches), 7, 1);
  EXPECT_GT(mean_nees(scene, {.covariance = CovarianceForm::residuals}, patches), 15);
}

}  // namespace
}  // namespace stillkite
