#include "stabilization/velocity_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillkite {
namespace {

const LevelMotion kCommand(0.2, -0.1, 0.05, 0.3);
constexpr double kLag_s = 0.5;

TEST(VelocityModel, FollowsAStepAsAFirstOrderLag) {
  VelocityModel own(kLag_s);
  own.advance({});
  own.set_command(kCommand);
  for (int k = 1; k <= 60; ++k) {
    own.advance(from_seconds(0.03 * k));
    const double t = 0.03 * k;
    const double gone = 1 - std::exp(-t / kLag_s);
    ASSERT_LT((own.rate() - kCommand * gone).norm(), 1e-9);
    ASSERT_LT((own.way_since({}) - kCommand * (t - kLag_s * gone)).norm(), 1e-9);
  }
  // between instants the way is linear, so off by at most dt^2 / 8 times the acceleration
  const double since_s = 1.0;
  const auto way = [](double t) { return t - kLag_s * (1 - std::exp(-t / kLag_s)); };
  EXPECT_LT((own.way_since(from_seconds(since_s)) - kCommand * (way(1.8) - way(1.0))).norm(),
            0.03 * 0.03 / 8 * kCommand.norm() / kLag_s);
}

TEST(VelocityModel, RemembersAsFarAsItCan) {
  VelocityModel own(0);
  own.set_command(kCommand);
  for (int k = 0; k < 1000; ++k) own.advance(from_seconds(0.01 * k));
  EXPECT_LT((own.way_since(from_seconds(9.49)) - 0.5 * kCommand).norm(), 1e-9);
  EXPECT_LT((own.way_since({}) - 1.27 * kCommand).norm(), 1e-9);
  EXPECT_EQ(own.way_since(from_seconds(20)).norm(), 0);
}

TEST(VelocityModel, NoTimeNoMotion) {
  VelocityModel own(kLag_s);
  EXPECT_EQ(own.way_since({}).norm(), 0);
  own.advance(from_seconds(1));
  own.set_command(kCommand);
  own.advance(from_seconds(1));
  own.advance(from_seconds(0.5));
  EXPECT_EQ(own.rate().norm(), 0);
}

}  // namespace
}  // namespace stillkite
