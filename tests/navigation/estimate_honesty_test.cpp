#include <gtest/gtest.h>

#include <iterator>
#include <opencv2/core.hpp>
#include <vector>

#include "evaluation/chi_square.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "tests/navigation/estimate_error.hpp"
#include "tests/navigation/known_flight.hpp"

// What the controller is told of its own error: never wrong and sure of it.

namespace stillkite {
namespace {

using test::ContractEstimator;
using test::kLast;
using test::kMotions;
using test::KnownFlight;
using test::KnownMotion;
using test::kTolerance;

bool has_way(const MotionEstimate& answer) {
  return answer.displacement_kind == DisplacementKind::metric ||
         answer.displacement_kind == DisplacementKind::direction;
}

// The lower 40 % of the image: blocks of 40x32 px, in each of which something else runs by, one
// to three pixels a frame to either side and up or down.
cv::Mat with_crowd(const cv::Mat& image, int index) {
  static const cv::Mat crowd = procedural_ground(600, 500, 2);
  constexpr int kWidth_px = 40;
  constexpr int kHeight_px = 32;
  cv::Mat out = image.clone();
  for (int top = image.rows * 6 / 10; top < image.rows; top += kHeight_px) {
    for (int left = 0; left < image.cols; left += kWidth_px) {
      Random random(static_cast<std::uint64_t>(top), static_cast<std::uint64_t>(left));
      const auto run = [&random] {
        const int speed_px = 1 + static_cast<int>(3 * random.uniform());
        return random.uniform() < 0.5 ? -speed_px : speed_px;
      };
      const cv::Rect to(left, top, kWidth_px, kHeight_px);
      const cv::Point from(100 + left / 2 + run() * index, 100 + top + run() * index);
      crowd(cv::Rect(from, to.size())).copyTo(out(to));
    }
  }
  return out;
}

class EstimateHonesty : public testing::TestWithParam<Policy> {};

// As near as where nothing is in the way, or as the covariance allows. It tells of noise, not of
// how those that move otherwise pull at the answer: measured are 12.5 sigma by the reference, 10.0
// by the flow.
TEST_P(EstimateHonesty, FortyPercentThatMoveOtherwiseAreNotBelieved) {
  int ok = 0;
  int wrong = 0;
  for (const KnownMotion& motion : kMotions) {
    const KnownFlight flight(motion);
    ContractEstimator estimator(GetParam(), flight.world_from_body_at_start());
    (void)estimator.step(KnownFlight::framed(with_crowd(flight.frame(0).grey, 0), 0));
    for (int i = 1; i <= kLast; ++i) {
      const MotionEstimate answer =
          estimator.step(KnownFlight::framed(with_crowd(flight.frame(i).grey, i), i));
      if (answer.status != EstimateStatus::ok) continue;
      ++ok;
      const double most = answer.source == EstimateSource::reference ? 13 * 13 : 11 * 11;
      const RigidTransform truth = flight.reference_from_camera(i);
      const Eigen::Vector3d turn = test::rotation_error(answer, truth);
      const bool has_turned_well = turn.norm() < kTolerance.rotation_rad ||
                                   test::squared_sigmas(turn, answer.rotation_covariance) < most;
      const double way_ratio = has_way(answer) ? test::displacement_error_ratio(answer, truth) : 0;
      const bool has_gone_well = way_ratio < kTolerance.length_ratio ||
                                 test::displacement_sigmas_squared(answer, truth) < most;
      const bool is_far_off = i >= kLast / 2 && (way_ratio >= 0.2 || turn.norm() >= 5 * kDegree);
      if (!has_turned_well || !has_gone_well || is_far_off) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(ok, 0.8 * kLast * static_cast<double>(std::size(kMotions)));
}

// A flight of 0.35 m and 8 degrees any way, over its own ground and with its own noise; what an
// estimator is told of the start is off by as much as it is told.
struct AnyFlight {
  KnownFlight flight;
  Eigen::Vector3d tilt_rad;
  double height_error_ratio;  // the fusion is told of one
  std::vector<Frame> frames;
};

AnyFlight any_flight(int number) {
  const double tilt_sigma_rad = NavigatorConfig{}.initial_tilt_sigma_rad;
  const auto seed = static_cast<std::uint64_t>(number);
  Random random(seed, 7);
  const auto draw = [&random] {
    const double x = random.normal();
    const double y = random.normal();
    return Eigen::Vector3d(x, y, random.normal());
  };
  const Eigen::Vector3d way_m = 0.35 * draw().normalized();
  const Eigen::Vector3d turn_rad = 8 * kDegree * draw().normalized();
  AnyFlight out{.flight = KnownFlight({"any", way_m, turn_rad}, seed),
                .tilt_rad = tilt_sigma_rad * draw().cwiseProduct(Eigen::Vector3d(1, 1, 0)),
                .height_error_ratio = FusionConfig{}.height_sigma_ratio * random.normal(),
                .frames = {}};
  out.frames.reserve(KnownFlight::kFrames);
  for (int i = 0; i <= kLast; ++i) out.frames.push_back(out.flight.frame(i));
  return out;
}

constexpr int kFlights = 20;

const std::vector<AnyFlight>& any_flights() {
  static const std::vector<AnyFlight> made = [] {
    std::vector<AnyFlight> flights;
    flights.reserve(kFlights);
    for (int number = 1; number <= kFlights; ++number) flights.push_back(any_flight(number));
    return flights;
  }();
  return made;
}

struct MeanNees {
  double rotation = 0;
  double displacement = 0;
};

MeanNees mean_nees(Policy policy) {
  MeanNees mean;
  for (const AnyFlight& any : any_flights()) {
    RigidTransform start = any.flight.world_from_body_at_start();
    start.rotation = so3_exp(any.tilt_rad) * start.rotation;
    if (policy == Policy::fused) start.translation.z() *= 1 + any.height_error_ratio;
    ContractEstimator estimator(policy, start);
    MotionEstimate answer;
    for (const Frame& frame : any.frames) answer = estimator.step(frame);
    EXPECT_EQ(answer.status, EstimateStatus::ok);
    const RigidTransform truth = any.flight.reference_from_camera(kLast);
    mean.rotation +=
        test::squared_sigmas(test::rotation_error(answer, truth), answer.rotation_covariance) /
        kFlights;
    mean.displacement += test::displacement_sigmas_squared(answer, truth) / kFlights;
  }
  return mean;
}

// The sum over independent flights is chi-square: 99 % of honest means lie within.
struct NeesBand {
  double low = 0;
  double high = 0;
};

NeesBand nees_band(int degrees_of_freedom) {
  const double dof = degrees_of_freedom * kFlights;
  return {chi_square_quantile(0.005, dof) / kFlights, chi_square_quantile(0.995, dof) / kFlights};
}

// The fusion is too careful on purpose (docs/fusion_honesty.md): the flow's covariance counts as
// many times as frames fall into a second.
TEST_P(EstimateHonesty, ErrsAsItsCovarianceSays) {
  const MeanNees mean = mean_nees(GetParam());
  RecordProperty("rotation_nees", std::to_string(mean.rotation));
  RecordProperty("displacement_nees", std::to_string(mean.displacement));
  const NeesBand rotation = nees_band(3);
  const NeesBand displacement = nees_band(GetParam() == Policy::reference ? 2 : 3);
  EXPECT_LT(mean.rotation, rotation.high);
  EXPECT_LT(mean.displacement, displacement.high);
  if (GetParam() != Policy::fused) {
    EXPECT_GT(mean.rotation, rotation.low);
    EXPECT_GT(mean.displacement, displacement.low);
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, EstimateHonesty,
                         testing::Values(Policy::flow, Policy::reference, Policy::best,
                                         Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

}  // namespace
}  // namespace stillkite
