#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "navigation/navigator_config.hpp"
#include "simulation/hover/plant_config.hpp"
#include "stabilization/hold_config.hpp"

namespace stillkite {

enum class SceneKind { room, coast };
template <>
struct EnumNames<SceneKind> {
  static constexpr auto value = std::to_array<std::pair<SceneKind, std::string_view>>(
      {{SceneKind::room, "room"}, {SceneKind::coast, "coast"}});
};

/// Number of flights along each of the paper's axes. Defaults: the paper's twelve trials.
struct TrialsConfig {
  int on = 3;
  int off = 1;
  bool estimate_off = false;

  static void fields(auto& self, auto&& field) {
    field("on", self.on, Range{0, 1000}, "flights per axis with stabilization");
    field("off", self.off, Range{0, 1000}, "flights per axis without stabilization");
    field("estimate_off", self.estimate_off,
          "run the estimator in flights without stabilization, too; its commands are ignored");
  }
};

/// Timing of the ground computer.
struct CycleConfig {
  double period_s = 0;
  double compute_s = 0.01;

  static void fields(auto& self, auto&& field) {
    field("period_s", self.period_s, Range{0, 5},
          "interval between processed frames; 0: every frame of the camera");
    field("compute_s", self.compute_s, Range{0, 5}, "time from a frame's arrival to the command");
  }
};

/// Video link from the drone to the ground computer.
struct LinkConfig {
  int jpeg_quality = 80;

  static void fields(auto& self, auto&& field) {
    field("jpeg_quality", self.jpeg_quality, Range{0, 100}, "JPEG quality; 0: no compression");
  }
};

/// Wires of a simulated drone that is served as a device.
struct ServeConfig {
  PaperAxis axis = PaperAxis::x;
  int video_port = 5600;
  int mavlink_port = 14550;
  double clock_offset_s = 1000;
  double clock_skew_ppm = 50;
  double jitter_s = 0;

  static void fields(auto& self, auto&& field) {
    field("axis", self.axis, "axis along which the station moves");
    field("video_port", self.video_port, Range{1, 65535}, "UDP port of the video on this machine");
    field("mavlink_port", self.mavlink_port, Range{1, 65535}, "UDP port of the IMU");
    field("clock_offset_s", self.clock_offset_s, Range{0, 1e6},
          "offset of the drone's clock from the simulation's");
    field("clock_skew_ppm", self.clock_skew_ppm, Range{-1000, 1000}, "skew of the drone's clock");
    field("jitter_s", self.jitter_s, Range{0, 1},
          "delay of each image beyond plant.camera_latency_s: uniform from 0 to this");
  }
};

/// Configuration of closed-loop trials.
struct HoverConfig {
  int seed = 1;
  SceneKind scene = SceneKind::room;
  TrialsConfig trials{};
  LinkConfig link{};
  CycleConfig cycle{};
  std::optional<std::filesystem::path> plant_file{};
  PlantConfig plant{};
  EstimatorConfig estimator{.policy = Policy::reference};
  NavigatorConfig navigator{};
  HoldConfig hold{};
  ServeConfig serve{};

  static void fields(auto& self, auto&& field) {
    field("seed", self.seed, kAnySeed, "seed of all random numbers; streams differ between trials");
    field("scene", self.scene, "scene in front of the camera");
    field("trials", self.trials, "number of flights");
    field("link", self.link, "video link");
    field("cycle", self.cycle, "timing of estimator and controller");
    field("plant_file", self.plant_file, "YAML file with the keys of `plant`; null: its defaults");
    field("plant", self.plant, "drone, sensors and station; overrides plant_file");
    field("estimator", self.estimator, "estimator policy and mode");
    field("navigator", self.navigator, "optical-flow estimator");
    field("reference", self.navigator.reference, "reference-image estimator");
    field("choice", self.navigator.choice, "per-frame selection between both estimators");
    field("fusion", self.navigator.fusion, "filter that fuses both estimators");
    field("hold", self.hold, "position-hold controller");
    field("serve", self.serve, "drone as a device, option --serve");
  }
};

}  // namespace stillkite
