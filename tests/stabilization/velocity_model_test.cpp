#include "stabilization/velocity_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillkite {
namespace {

const TranslationYaw kCommand(0.2, -0.1, 0.05, 0.3);
constexpr double kVelocityLag_s = 0.5;

TEST(VelocityModel, StepResponseIsFirstOrderLag) {
  VelocityModel model(kVelocityLag_s);
  model.advance({});
  model.set_command(kCommand);
  for (int k = 1; k <= 60; ++k) {
    model.advance(from_seconds(0.03 * k));
    const double t = 0.03 * k;
    const double response = 1 - std::exp(-t / kVelocityLag_s);
    ASSERT_LT((model.rate() - kCommand * response).norm(), 1e-9);
    ASSERT_LT((model.displacement_since({}) - kCommand * (t - kVelocityLag_s * response)).norm(),
              1e-9);
  }
  // linear interpolation between instants: error at most dt^2 / 8 x acceleration
  const double since_s = 1.0;
  const auto displacement = [](double t) {
    return t - kVelocityLag_s * (1 - std::exp(-t / kVelocityLag_s));
  };
  EXPECT_LT((model.displacement_since(from_seconds(since_s)) -
             kCommand * (displacement(1.8) - displacement(1.0)))
                .norm(),
            0.03 * 0.03 / 8 * kCommand.norm() / kVelocityLag_s);
}

TEST(VelocityModel, DisplacementIsLimitedToTheHistory) {
  VelocityModel model(0);
  model.set_command(kCommand);
  for (int k = 0; k < 1000; ++k) model.advance(from_seconds(0.01 * k));
  EXPECT_LT((model.displacement_since(from_seconds(9.49)) - 0.5 * kCommand).norm(), 1e-9);
  EXPECT_LT((model.displacement_since({}) - 1.27 * kCommand).norm(), 1e-9);
  EXPECT_EQ(model.displacement_since(from_seconds(20)).norm(), 0);
}

TEST(VelocityModel, DoesNotMoveWithoutElapsedTime) {
  VelocityModel model(kVelocityLag_s);
  EXPECT_EQ(model.displacement_since({}).norm(), 0);
  model.advance(from_seconds(1));
  model.set_command(kCommand);
  model.advance(from_seconds(1));
  model.advance(from_seconds(0.5));
  EXPECT_EQ(model.rate().norm(), 0);
}

}  // namespace
}  // namespace stillkite
