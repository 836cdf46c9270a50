#include "estimation/sliding_window/marginalization.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "estimation/sliding_window/window_solver.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

Eigen::VectorXd newton_step(const Window& window, Eigen::MatrixXd& covariance) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  const Eigen::Index size = equations.gradient.size();
  covariance = factor.solve(Eigen::MatrixXd::Identity(size, size));
  return factor.solve(equations.gradient);
}

TEST(Marginalization, OfVelocityAndBiasesKeepsStepAndCovarianceOfTheRest) {
  Window window = true_window();
  Eigen::MatrixXd before, after;
  const Eigen::VectorXd step = newton_step(window, before);
  marginalize_motion(window, 0);
  const Eigen::VectorXd kept = newton_step(window, after);
  constexpr int kNewest = InertialIndex::kSize;
  EXPECT_LT((kept.tail<kNewest>() - step.tail<kNewest>()).norm(), 1e-6 * step.norm());
  const Eigen::MatrixXd expected = before.bottomRightCorner(kNewest, kNewest);
  const Eigen::MatrixXd difference = after.bottomRightCorner(kNewest, kNewest) - expected;
  EXPECT_LT(difference.norm(), 1e-6 * expected.norm());
}

// Observations of the other keyframe's points in the removed frame are lost, and so is nothing
// else: the covariance does not shrink, and grows little.
TEST(Marginalization, OfAKeyframeNeverGainsInformation) {
  Window window = true_window();
  Eigen::MatrixXd before, after;
  newton_step(window, before);
  marginalize_frame(window, 0);
  EXPECT_EQ(window.frames.size(), 3U);
  newton_step(window, after);
  constexpr int kNewest = InertialIndex::kSize;
  const Eigen::VectorXd ratio =
      after.diagonal().tail<kNewest>().array() / before.diagonal().tail<kNewest>().array();
  EXPECT_GT(ratio.minCoeff(), 1 - 1e-6);
  EXPECT_LT(ratio.maxCoeff(), 3);
}

// With first estimates where the window was before, a displacement of the whole window would change
// baselines and IMU motions between frames with and without one.
TEST(Marginalization, DisplacementOfTheWindowChangesNoEquations) {
  Window window = true_window();
  marginalize_motion(window, 0);
  ASSERT_TRUE(window.frames[1].first_estimate);
  ASSERT_FALSE(window.frames[2].first_estimate);
  const WindowEquations before = window_equations(window, whole_window(window));
  const Eigen::Vector3d displacement(0.3, -0.2, 0.1);
  for (WindowFrame& frame : window.frames) {
    frame.state.world_from_imu.translation += displacement;
  }
  window.ground.height_m += displacement.z();
  move_first_estimates(window);
  const WindowEquations after = window_equations(window, whole_window(window));
  EXPECT_LT((after.information - before.information).norm(), 1e-9 * before.information.norm());
}

TEST(Marginalization, FirstEstimatesFollowASimilarity) {
  Window window = true_window();
  marginalize_motion(window, 0);
  for (WindowFrame& frame : window.frames) {
    frame.state.world_from_imu.translation =
        1.1 * frame.state.world_from_imu.translation + Eigen::Vector3d(1, 2, 3);
    frame.state.velocity_in_world_m_s *= 1.1;
  }
  move_first_estimates(window);
  for (const WindowFrame& frame : window.frames) {
    if (!frame.first_estimate) continue;
    const InertialError error = minus(frame.state, *frame.first_estimate);
    EXPECT_LT(error.segment<3>(InertialIndex::kPosition).norm(), 1e-9) << frame.id;
    if (!frame.has_motion) continue;
    EXPECT_LT(error.segment<3>(InertialIndex::kVelocity).norm(), 1e-9) << frame.id;
  }
}

TEST(Marginalization, PriorIsTheSameFunctionOfTheLengths) {
  Window window = true_window();
  marginalize_motion(window, 0);
  std::srand(3);
  for (WindowFrame& frame : window.frames) {
    frame.state = plus(frame.state, 0.01 * InertialError::Random());
  }
  window.ground = plus(window.ground, 0.01 * GroundError::Random());
  const WindowEquations before = window_equations(window, {});
  move_first_estimates(window);
  const WindowEquations after = window_equations(window, {});
  EXPECT_EQ(window.frames[1].first_estimate->world_from_imu.translation,
            window.frames[1].state.world_from_imu.translation);
  EXPECT_LT((after.information - before.information).norm(), 1e-12 * before.information.norm());
  EXPECT_LT((after.gradient - before.gradient).norm(), 1e-9 * before.gradient.norm());
}

TEST(Marginalization, MergedFrameKeepsTheImuChain) {
  Window window = true_window();
  const double duration_s = window.frames[2].imu.duration_s() + window.frames[3].imu.duration_s();
  merge_frame(window, 2);
  ASSERT_EQ(window.frames.size(), 3U);
  EXPECT_DOUBLE_EQ(window.frames[2].imu.duration_s(), duration_s);
  EXPECT_EQ(window.prior.gradient.size(), window.offsets().back());
  for (const WindowTrack& track : window.tracks) {
    for (const WindowObservation& observation : track.observations) {
      EXPECT_TRUE(window.find(observation.frame_id));
    }
  }
}

}  // namespace
}  // namespace stillkite
