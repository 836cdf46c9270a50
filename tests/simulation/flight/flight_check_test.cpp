#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "simulation/flight/simulate.hpp"

namespace stillkite {
namespace {

SimulationConfig room_flight() {
  SimulationConfig config;
  config.scene = FlightScene::room;
  config.flight = {.shape = FlightShape::hand, .duration_s = 1, .height_m = 1.5, .sway_m = 0.2};
  return config;
}

std::string error_of(const std::function<void(SimulationConfig&)>& change) {
  SimulationConfig config = room_flight();
  change(config);
  try {
    (void)record_flight(config);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(FlightCheck, AcceptsRoomFlightWithoutRangeFinder) {
  EXPECT_EQ(error_of([](SimulationConfig&) {}), "none");
  EXPECT_TRUE(record_flight(room_flight()).range.empty());
}

TEST(FlightCheck, NamesContradictingKey) {
  const auto starts_with = [](const std::string& text, const std::string& key) {
    return text.compare(0, key.size(), key) == 0;
  };
  EXPECT_PRED2(starts_with, error_of([](auto& config) { config.camera.readout_s = 0.05; }),
               "camera.readout_s");
  EXPECT_PRED2(starts_with, error_of([](auto& config) { config.clock.rounding_s = 0.01; }),
               "clock.rounding_s");
  EXPECT_PRED2(starts_with, error_of([](auto& config) { config.imu.gap_s = 10; }), "imu.gap_s");
  EXPECT_PRED2(starts_with, error_of([](auto& config) { config.vehicle.emplace(); }), "vehicle");
  EXPECT_PRED2(starts_with, error_of([](auto& config) { config.shadow.emplace(); }), "shadow");
  EXPECT_PRED2(starts_with, error_of([](auto& config) {
                 config.camera.shutter_s = 0.01;
                 config.camera.shutter_samples = 3;
               }),
               "camera.shutter_samples");
  EXPECT_PRED2(starts_with, error_of([](auto& config) {
                 config.camera.lever_arm_m = {7, 0, 0};
               }),
               "scene");
}

}  // namespace
}  // namespace stillkite
