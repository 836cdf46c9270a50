#include <gtest/gtest.h>

#include <iterator>
#include <opencv2/core.hpp>
#include <vector>

#include "geometry/chi_square.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "tests/navigation/estimate_error.hpp"
#include "tests/navigation/prescribed_flight.hpp"

// Consistency of the covariances given to the controller.

namespace stillkite {
namespace {

using test::ContractEstimator;
using test::kLastFrame;
using test::kMotions;
using test::kTolerance;
using test::PrescribedFlight;
using test::PrescribedMotion;

bool has_displacement(const MotionEstimate& answer) {
  return answer.displacement_kind == DisplacementKind::metric ||
         answer.displacement_kind == DisplacementKind::direction;
}

// Replaces the lower 40 % of the image by blocks of 40x32 px that move independently, by one to
// three pixels per frame in x and y.
cv::Mat with_moving_objects(const cv::Mat& image, int index) {
  static const cv::Mat texture = procedural_ground(600, 500, 2);
  constexpr int kWidth_px = 40;
  constexpr int kHeight_px = 32;
  cv::Mat out = image.clone();
  for (int top = image.rows * 6 / 10; top < image.rows; top += kHeight_px) {
    for (int left = 0; left < image.cols; left += kWidth_px) {
      Random random(static_cast<std::uint64_t>(top), static_cast<std::uint64_t>(left));
      const auto velocity = [&random] {
        const int magnitude_px = 1 + static_cast<int>(3 * random.uniform());
        return random.uniform() < 0.5 ? -magnitude_px : magnitude_px;
      };
      const cv::Rect to(left, top, kWidth_px, kHeight_px);
      const cv::Point from(100 + left / 2 + velocity() * index, 100 + top + velocity() * index);
      texture(cv::Rect(from, to.size())).copyTo(out(to));
    }
  }
  return out;
}

class EstimateConsistency : public testing::TestWithParam<Policy> {};

// Error within the tolerances of the unoccluded scene, or consistent with the covariance. The
// covariance models noise, not the bias by moving objects: measured are 12.5 sigma for the
// reference, 2.5 for the flow.
TEST_P(EstimateConsistency, RejectsMovingObjectsOnFortyPercentOfImage) {
  int ok = 0;
  int wrong = 0;
  for (const PrescribedMotion& motion : kMotions) {
    const PrescribedFlight flight(motion);
    ContractEstimator estimator(GetParam(), flight.world_from_body_at_start());
    (void)estimator.step(PrescribedFlight::framed(with_moving_objects(flight.frame(0).grey, 0), 0));
    for (int i = 1; i <= kLastFrame; ++i) {
      const MotionEstimate answer =
          estimator.step(PrescribedFlight::framed(with_moving_objects(flight.frame(i).grey, i), i));
      if (answer.status != EstimateStatus::ok) continue;
      ++ok;
      const double max_nees = answer.source == EstimateSource::reference ? 13 * 13 : 4 * 4;
      const RigidTransform truth = flight.reference_from_camera(i);
      const Eigen::Vector3d rotation_error = test::rotation_error(answer, truth);
      const bool is_rotation_consistent =
          rotation_error.norm() < kTolerance.rotation_rad ||
          test::nees(rotation_error, answer.rotation_covariance) < max_nees;
      const double displacement_ratio =
          has_displacement(answer) ? test::displacement_error_ratio(answer, truth) : 0;
      const bool is_displacement_consistent = displacement_ratio < kTolerance.length_ratio ||
                                              test::displacement_nees(answer, truth) < max_nees;
      const bool is_gross_error = i >= kLastFrame / 2 && (displacement_ratio >= 0.25 ||
                                                          rotation_error.norm() >= 5 * kDegree);
      if (!is_rotation_consistent || !is_displacement_consistent || is_gross_error) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(ok, 0.6 * kLastFrame * static_cast<double>(std::size(kMotions)));
}

// Flight of 0.35 m and 8 degrees in random directions, with its own ground and noise. The initial
// pose has random errors with the configured standard deviations.
struct RandomFlight {
  PrescribedFlight flight;
  Eigen::Vector3d tilt_rad;
  double height_error_ratio;  // modelled by the fusion only
  std::vector<Frame> frames;
};

RandomFlight random_flight(int number) {
  const double tilt_sigma_rad = NavigatorConfig{}.initial_tilt_sigma_rad;
  const auto seed = static_cast<std::uint64_t>(number);
  Random random(seed, 7);
  const auto draw = [&random] {
    const double x = random.normal();
    const double y = random.normal();
    return Eigen::Vector3d(x, y, random.normal());
  };
  const Eigen::Vector3d translation_m = 0.35 * draw().normalized();
  const Eigen::Vector3d rotation_rad = 8 * kDegree * draw().normalized();
  RandomFlight out{.flight = PrescribedFlight({"random", translation_m, rotation_rad}, seed),
                   .tilt_rad = tilt_sigma_rad * draw().cwiseProduct(Eigen::Vector3d(1, 1, 0)),
                   .height_error_ratio = FusionConfig{}.height_sigma_ratio * random.normal(),
                   .frames = {}};
  out.frames.reserve(PrescribedFlight::kFrames);
  for (int i = 0; i <= kLastFrame; ++i) out.frames.push_back(out.flight.frame(i));
  return out;
}

constexpr int kFlights = 20;

const std::vector<RandomFlight>& random_flights() {
  static const std::vector<RandomFlight> shared = [] {
    std::vector<RandomFlight> flights;
    flights.reserve(kFlights);
    for (int number = 1; number <= kFlights; ++number) flights.push_back(random_flight(number));
    return flights;
  }();
  return shared;
}

struct MeanNees {
  double rotation = 0;
  double displacement = 0;
};

MeanNees mean_nees(Policy policy) {
  MeanNees mean;
  for (const RandomFlight& random : random_flights()) {
    RigidTransform start = random.flight.world_from_body_at_start();
    start.rotation = so3_exp(random.tilt_rad) * start.rotation;
    if (policy == Policy::fused) start.translation.z() *= 1 + random.height_error_ratio;
    ContractEstimator estimator(policy, start, {.lens_sigma_px = 0});
    MotionEstimate answer;
    for (const Frame& frame : random.frames) answer = estimator.step(frame);
    EXPECT_EQ(answer.status, EstimateStatus::ok);
    const RigidTransform truth = random.flight.reference_from_camera(kLastFrame);
    mean.rotation +=
        test::nees(test::rotation_error(answer, truth), answer.rotation_covariance) / kFlights;
    mean.displacement += test::displacement_nees(answer, truth) / kFlights;
  }
  return mean;
}

// 99 % interval of the mean NEES of consistent covariances: the sum over flights is chi-square.
struct NeesBand {
  double low = 0;
  double high = 0;
};

NeesBand nees_band(int degrees_of_freedom) {
  const double dof = degrees_of_freedom * kFlights;
  return {chi_square_quantile(0.005, dof) / kFlights, chi_square_quantile(0.995, dof) / kFlights};
}

// Conservative by design: the fusion inflates the flow's covariance by the number of frames per
// second (docs/fusion_honesty.md), the flow allows for relief that its measurement does not exclude
// over this exactly flat ground.
TEST_P(EstimateConsistency, CovarianceMatchesErrors) {
  const MeanNees mean = mean_nees(GetParam());
  RecordProperty("rotation_nees", std::to_string(mean.rotation));
  RecordProperty("displacement_nees", std::to_string(mean.displacement));
  const NeesBand rotation = nees_band(3);
  const NeesBand displacement = nees_band(GetParam() == Policy::reference ? 2 : 3);
  EXPECT_LT(mean.rotation, rotation.high);
  EXPECT_LT(mean.displacement, displacement.high);
  if (GetParam() == Policy::reference) {
    EXPECT_GT(mean.rotation, rotation.low);
    EXPECT_GT(mean.displacement, displacement.low);
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, EstimateConsistency,
                         testing::Values(Policy::flow, Policy::reference, Policy::best,
                                         Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

}  // namespace
}  // namespace stillkite
