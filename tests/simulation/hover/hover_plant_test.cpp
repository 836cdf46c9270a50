#include "simulation/hover/hover_plant.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

constexpr int kStepsPerSecond = 600;

// Without commands the drone follows its station.
TEST(HoverPlant, StationRestsUntilTheTrialBegins) {
  const HoverConfig config;
  HoverPlant at_once(config, {}), waiting(config, {});
  const Eigen::Vector3d start = at_once.truth().world_from_body.translation;
  waiting.wait();
  for (int i = 0; i < 3 * kStepsPerSecond; ++i) waiting.step({});
  EXPECT_EQ(waiting.now(), from_seconds(3));
  EXPECT_EQ(waiting.trial_s(), 0);
  EXPECT_LT((waiting.truth().world_from_body.translation - start).norm(), 1e-9);
  waiting.begin();
  for (int i = 0; i < 5 * kStepsPerSecond; ++i) {
    at_once.step({});
    waiting.step({});
  }
  EXPECT_EQ(waiting.trial_s(), 5);
  const Eigen::Vector3d moved = at_once.truth().world_from_body.translation;
  EXPECT_GT((moved - start).norm(), 0.7);
  EXPECT_LT((waiting.truth().world_from_body.translation - moved).norm(), 1e-9);
}

TEST(HoverPlant, TrialEndsItsDurationAfterItsBeginning) {
  const HoverConfig config;
  HoverPlant plant(config, {});
  plant.wait();
  const int steps = static_cast<int>(trial_duration_s(config, {}) * kStepsPerSecond);
  for (int i = 0; i < 2 * steps; ++i) plant.step({});
  EXPECT_FALSE(plant.is_over());
  plant.begin();
  for (int i = 0; i < steps; ++i) plant.step({});
  EXPECT_FALSE(plant.is_over());
  for (int i = 0; i < 2; ++i) plant.step({});
  EXPECT_TRUE(plant.is_over());
}

}  // namespace
}  // namespace stillkite
