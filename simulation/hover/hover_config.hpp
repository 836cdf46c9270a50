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

/// How many flights along each of the paper's axes; the paper's twelve are the defaults.
struct TrialsConfig {
  int on = 3;
  int off = 1;
  bool estimate_off = false;

  static void fields(auto& self, auto&& field) {
    field("on", self.on, Range{0, 1000}, "flights an axis with stabilization");
    field("off", self.off, Range{0, 1000}, "flights an axis without");
    field("estimate_off", self.estimate_off,
          "whether the estimator runs in these too, and is not obeyed");
  }
};

/// How long the computer on the ground takes.
struct CycleConfig {
  double period_s = 0;
  double compute_s = 0.01;

  static void fields(auto& self, auto&& field) {
    field("period_s", self.period_s, Range{0, 5},
          "from one frame that is looked at to the next; 0: every frame of the camera");
    field("compute_s", self.compute_s, Range{0, 5}, "from a frame's arrival to the command");
  }
};

/// From the drone to the computer on the ground.
struct LinkConfig {
  int jpeg_quality = 80;

  static void fields(auto& self, auto&& field) {
    field("jpeg_quality", self.jpeg_quality, Range{0, 100},
          "of the compressed images; 0: they are not compressed");
  }
};

/// Everything that closed-loop trials can be told.
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

  static void fields(auto& self, auto&& field) {
    field("seed", self.seed, kAnySeed, "of everything random; every trial has streams of its own");
    field("scene", self.scene, "what the camera sees");
    field("trials", self.trials, "how many flights");
    field("link", self.link, "what images suffer on their way");
    field("cycle", self.cycle, "how fast estimator and controller are");
    field("plant_file", self.plant_file, "YAML file with the keys of `plant`; null: its defaults");
    field("plant", self.plant, "the drone, its sensors and its station, over those of the file");
    field("estimator", self.estimator, "how the motion is found");
    field("navigator", self.navigator, "the flow navigator");
    field("reference", self.navigator.reference, "the reference estimator");
    field("choice", self.navigator.choice, "of either estimator's answer, frame by frame");
    field("fusion", self.navigator.fusion, "both estimators in one filter");
    field("hold", self.hold, "the controller");
  }
};

}  // namespace stillkite
