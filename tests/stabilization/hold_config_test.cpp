#include "stabilization/hold_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "stabilization/hold_controller.hpp"
#include "tests/stabilization/hold_scene.hpp"

namespace stillkite {
namespace {

// 4 cm above the reference position, tether ahead and up: no limit is reached.
HoldInput displaced_input(Timestamp now) {
  HoldInput input{
      .now = now,
      .estimate = exact_estimate({forward_camera(), {1, 0, 1}}, {forward_camera(), {1, 0, 1.04}}),
      .tether = TetherReading{.stamp = now, .tether = {std::sqrt(2.0), 0.7854, 0}},
      .station_from_camera = forward_camera()};
  input.estimate->stamp = now;
  return input;
}

// Visits every number of a config struct recursively.
struct CheckDefaults {
  std::string path;
  int& numbers;

  void operator()(const char* key, double value, Range range, std::string_view sentence) const {
    EXPECT_TRUE(range.contains(value)) << path << key;
    EXPECT_FALSE(sentence.empty()) << path << key;
    ++numbers;
  }
  void operator()(const char* key, const std::optional<double>& value, Range range,
                  std::string_view sentence) const {
    if (value) (*this)(key, *value, range, sentence);
  }
  void operator()(const char*, bool, std::string_view) const {}
  void operator()(const char*, HoldMode, std::string_view) const {}
  template <typename Struct>
  void operator()(const char* key, const Struct& nested, std::string_view) const {
    Struct::fields(nested, CheckDefaults{path + key + ".", numbers});
  }
};

TEST(HoldConfig, DefaultsAreWithinTheirRanges) {
  int numbers = 0;
  const HoldConfig config;
  HoldConfig::fields(config, CheckDefaults{"", numbers});
  EXPECT_EQ(numbers, 4 + 9 + (3 + 4 * 7) + (2 * 7 + 8));
}

// Double pole at -1.5 /s for a lag of 0.5 s and a latency of 0.13 s (docs/hold_control.md).
TEST(HoldConfig, PositionGainsPlaceTheirPoles) {
  const RecommendedHoldConfig config;
  constexpr double kPole_1_s = 1.5;
  EXPECT_NEAR(config.position.integral, kPole_1_s * kPole_1_s, 1e-12);
  EXPECT_NEAR(config.position.proportional,
              2 * kPole_1_s + (config.lag_s + 0.13) * kPole_1_s * kPole_1_s, 0.02);
}

// Largest multiple of 0.1 /s with pole x latency <= 0.4.
TEST(HoldConfig, StateFeedbackPoleFollowsItsDesignRule) {
  const double pole_1_s = RecommendedHoldConfig{}.state_feedback_pole_1_s;
  EXPECT_LE(pole_1_s * 0.13, 0.4);
  EXPECT_GT((pole_1_s + 0.1) * 0.13, 0.4);
}

// The relay's speed is above the station's and below the limit for stopping within the dead zone.
TEST(HoldConfig, PaperGainsFollowTheirDesignRule) {
  const PaperHoldConfig config;
  const double dead_zone_m = config.min_shift_px * 4 / 420;
  const double after_s = 1.5 * 0.206 + 0.5;
  for (const PidConfig& pid : {config.length, config.elevation, config.azimuth}) {
    EXPECT_GT(pid.proportional * config.unit_translation_m, 0.2);
    EXPECT_LT(pid.proportional * config.unit_translation_m * after_s, 2 * dead_zone_m);
  }
}

// The commands are not executed: a constant error must give a constant command.
TEST(HoldConfig, ShadowModeHasNoIntegralAction) {
  HoldConfig config;
  config.paper.length.integral = 1;
  for (const HoldMode mode : {HoldMode::paper, HoldMode::recommended}) {
    config.mode = mode;
    HoldController controller(in_shadow_mode(config));
    std::optional<HoldDecision> first;
    for (int i = 0; i < 100; ++i) {
      const HoldDecision decision = controller.decide(displaced_input(from_seconds(i / 30.0)));
      ASSERT_EQ(decision.action, HoldAction::command);
      if (!first) first = decision;
      EXPECT_EQ(decision.command.length_rate_m_s, first->command.length_rate_m_s) << i;
      EXPECT_EQ(decision.command.elevation_rate_rad_s, first->command.elevation_rate_rad_s) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
