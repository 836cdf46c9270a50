#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "geometry/angle.hpp"
#include "geometry/chi_square.hpp"
#include "tests/navigation/estimate_error.hpp"
#include "tests/navigation/prescribed_flight.hpp"

// One contract for all estimators: the same motion in the same frame, sign and unit, or the status
// specified in docs/hold_control.md.

namespace stillkite {
namespace {

using test::ContractEstimator;
using test::kLastFrame;
using test::kMotions;
using test::kRotation_rad;
using test::kTolerance;
using test::kTranslation_m;
using test::PrescribedFlight;
using test::PrescribedMotion;

// Specified results over flat ground: docs/hold_control.md.
struct Expected {
  EstimateSource source;
  DisplacementKind kind;
  ScaleSource scale;
  EstimateStatus unmeasured;
};
Expected expected_of(Policy policy) {
  constexpr auto kMetric = DisplacementKind::metric;
  constexpr auto kHeight = ScaleSource::initial_height;
  switch (policy) {
    case Policy::flow:
    case Policy::best:
      return {EstimateSource::flow, kMetric, kHeight, EstimateStatus::lost};
    case Policy::fused:
      return {EstimateSource::fused, kMetric, kHeight, EstimateStatus::predicted};
    case Policy::reference:
      break;
  }
  return {EstimateSource::reference, DisplacementKind::direction, ScaleSource::none,
          EstimateStatus::lost};
}

bool is_covariance(const Eigen::Matrix3d& P) {
  if (!P.allFinite() || !P.isApprox(P.transpose(), 1e-6)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(P, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -1e-9 * P.norm();
}

void expect_numbers(const MotionEstimate& answer) {
  EXPECT_TRUE(answer.reference_from_camera.coeffs().allFinite());
  EXPECT_NEAR(answer.reference_from_camera.norm(), 1, 1e-9);
  EXPECT_TRUE(answer.displacement_in_reference.allFinite());
  EXPECT_TRUE(is_covariance(answer.rotation_covariance)) << answer.rotation_covariance;
  EXPECT_TRUE(is_covariance(answer.displacement_covariance)) << answer.displacement_covariance;
  EXPECT_TRUE(std::isfinite(answer.mean_shift_px) && std::isfinite(answer.parallax_rad));
  EXPECT_TRUE(std::isfinite(answer.scale_age_s));
  EXPECT_TRUE(!answer.twist_in_camera || answer.twist_in_camera->vector().allFinite());
}

class EstimateContract : public testing::TestWithParam<Policy> {};

TEST_P(EstimateContract, EstimatesPrescribedMotionInFrameSignAndUnit) {
  const Expected expected = expected_of(GetParam());
  for (const PrescribedMotion& motion : kMotions) {
    SCOPED_TRACE(motion.name);
    const PrescribedFlight flight(motion);
    ContractEstimator estimator(GetParam(), flight.world_from_body_at_start());
    MotionEstimate answer;
    for (int i = 0; i <= kLastFrame; ++i) {
      const Frame frame = flight.frame(i);
      answer = estimator.step(frame);
      expect_numbers(answer);
      EXPECT_EQ(answer.status, EstimateStatus::ok) << i;
      EXPECT_EQ(answer.stamp, frame.stamp);
    }
    const RigidTransform truth = flight.reference_from_camera(kLastFrame);
    EXPECT_EQ(answer.source, expected.source);
    EXPECT_EQ(answer.displacement_kind, expected.kind);
    EXPECT_EQ(answer.scale, expected.scale);
    EXPECT_LT(test::rotation_error(answer, truth).norm(), kTolerance.rotation_rad);
    EXPECT_LT(test::direction_error_rad(answer, truth), kTolerance.direction_rad);
    const bool is_metric = expected.kind == DisplacementKind::metric;
    const double length = is_metric ? kTranslation_m : 1;
    EXPECT_NEAR(answer.displacement_in_reference.norm(), length, length * kTolerance.length_ratio);
    const double age_s = is_metric ? kLastFrame / PrescribedFlight::kFramesPerSecond : 0;
    EXPECT_NEAR(answer.scale_age_s, age_s, 1e-6);
    const Twist twist = flight.mean_twist_in_camera(kLastFrame);
    ASSERT_TRUE(answer.twist_in_camera);
    EXPECT_LT((answer.twist_in_camera->angular_rate_rad_s - twist.angular_rate_rad_s).norm(),
              kTolerance.rate_rad_s);
    const Eigen::Vector3d velocity_m_s = is_metric ? twist.velocity_m_s : Eigen::Vector3d::Zero();
    EXPECT_LT((answer.twist_in_camera->velocity_m_s - velocity_m_s).norm(),
              kTolerance.velocity_m_s);
  }
}

TEST_P(EstimateContract, PureRotationHasNoTranslation) {
  const double max_nees = chi_square_quantile(0.9973, 3);
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    const PrescribedFlight flight(
        {.name = "rotation",
         .rotation_in_reference_rad = kRotation_rad * Eigen::Vector3d::Unit(axis)});
    ContractEstimator estimator(GetParam(), flight.world_from_body_at_start());
    MotionEstimate answer;
    for (int i = 0; i <= kLastFrame; ++i) answer = estimator.step(flight.frame(i));
    expect_numbers(answer);
    EXPECT_EQ(answer.status, EstimateStatus::ok);
    EXPECT_LT(test::rotation_error(answer, flight.reference_from_camera(kLastFrame)).norm(),
              kTolerance.rotation_rad);
    const Eigen::Vector3d& displacement = answer.displacement_in_reference;
    EXPECT_NE(answer.displacement_kind, DisplacementKind::direction);
    if (answer.displacement_kind == DisplacementKind::zero) {
      EXPECT_TRUE(displacement.isZero());
    }
    if (answer.displacement_kind == DisplacementKind::metric) {
      EXPECT_LT(test::nees(displacement, answer.displacement_covariance), max_nees);
      EXPECT_LT(displacement.norm(), kTranslation_m * kTolerance.length_ratio);
    }
  }
}

struct ImageLoss {
  const char* name;
  std::function<cv::Mat(const cv::Mat& last, int index)> image;
};
const ImageLoss kImageLosses[] = {
    {"black",
     [](const cv::Mat& last, int) { return cv::Mat(last.size(), CV_8UC1, cv::Scalar(0)); }},
    {"textureless",
     [](const cv::Mat& last, int index) {
       return develop(cv::Mat(last.size(), CV_32FC1, cv::Scalar(128)), {.noise_grey = 1.5},
                      1000 + static_cast<std::uint64_t>(index));
     }},
    {"frozen", [](const cv::Mat& last, int) { return last.clone(); }}};

TEST_P(EstimateContract, UnmeasuredFramesHaveStatusAndGrowingCovariance) {
  const Expected expected = expected_of(GetParam());
  for (const ImageLoss& loss : kImageLosses) {
    SCOPED_TRACE(loss.name);
    const PrescribedFlight flight(kMotions[5]);
    ContractEstimator estimator(GetParam(), flight.world_from_body_at_start());
    MotionEstimate before;
    for (int i = 0; i <= kLastFrame; ++i) before = estimator.step(flight.frame(i));
    const cv::Mat last = flight.frame(kLastFrame).grey;
    for (int i = kLastFrame + 1; i <= kLastFrame + 5; ++i) {
      SCOPED_TRACE(i);
      const MotionEstimate answer =
          estimator.step(PrescribedFlight::framed(loss.image(last, i), i));
      expect_numbers(answer);
      EXPECT_EQ(answer.status, expected.unmeasured);
      EXPECT_EQ(answer.source, expected.source);
      EXPECT_GT(answer.rotation_covariance.trace(), before.rotation_covariance.trace());
      if (expected.kind == DisplacementKind::metric) {
        EXPECT_EQ(answer.displacement_kind, DisplacementKind::metric);
        EXPECT_GT(answer.displacement_covariance.trace(), before.displacement_covariance.trace());
      } else {
        EXPECT_EQ(answer.displacement_kind, DisplacementKind::unknown);
      }
      before = answer;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, EstimateContract,
                         testing::Values(Policy::flow, Policy::reference, Policy::best,
                                         Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

}  // namespace
}  // namespace stillkite
