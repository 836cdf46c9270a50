#include <gtest/gtest.h>

#include "tests/navigation/rendered_flight.hpp"

// Covariance consistency: NEES over flights with different grounds, noise and trajectories.
// Expected value 3 for three axes, here within a factor of four: errors within a flight are
// correlated.

namespace stillkite {
namespace {

using test::fly;

struct Nees {
  double velocity = 0;
  double rate = 0;
  int frames = 0;
};

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

void add_flight(int seed, Nees& sum) {
  const test::RenderedFlight flight = test::render_flight(test::small_flight(seed));
  const auto estimates = fly(flight.navigator({.lens_sigma_px = 0}), flight.frames);
  for (std::size_t i = 5; i < estimates.size(); ++i) {
    ASSERT_EQ(estimates[i].verdict, Verdict::ok);
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    const Twist& twist = estimates[i].twist_in_camera;
    const Matrix6d& P = estimates[i].twist_covariance;
    sum.velocity += nees(twist.velocity_m_s - truth.velocity_m_s, P.topLeftCorner<3, 3>());
    sum.rate +=
        nees(twist.angular_rate_rad_s - truth.angular_rate_rad_s, P.bottomRightCorner<3, 3>());
    ++sum.frames;
  }
}

TEST(Consistency, TwistNeesMatchesCovariance) {
  Nees sum;
  for (const int seed : {1, 2, 3, 4, 5, 6}) add_flight(seed, sum);
  const double velocity = sum.velocity / sum.frames;
  const double rate = sum.rate / sum.frames;
  RecordProperty("velocity_nees", std::to_string(velocity));
  RecordProperty("rate_nees", std::to_string(rate));
  // relief that the images do not exclude is allowed for: conservative over exactly flat ground,
  // where the models halve the error but not this part (NEES of one model: 0.25, 0.19)
  EXPECT_GT(velocity, 3.0 / 60);
  EXPECT_LT(velocity, 3.0);
  EXPECT_GT(rate, 3.0 / 60);
  EXPECT_LT(rate, 3.0);
}

}  // namespace
}  // namespace stillkite
