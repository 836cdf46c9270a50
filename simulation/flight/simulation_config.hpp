#pragma once

#include <filesystem>
#include <optional>

#include "simulation/flight/camera_config.hpp"
#include "simulation/flight/flight.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite {

struct GroundConfig {
  std::optional<std::filesystem::path> photograph{};
  std::optional<double> metres_per_texel{};
  int side_texels = 4096;
  ReliefConfig relief{};

  static void fields(auto& self, auto&& field) {
    field("photograph", self.photograph, "aerial image of the ground; null: procedural texture");
    field("metres_per_texel", self.metres_per_texel, kPositive,
          "texel size on the ground; null: 0.8 pixel footprints at the initial height");
    field("side_texels", self.side_texels, Range{64, 16384},
          "side length of the procedural texture, which repeats mirrored");
    field("relief", self.relief, "terrain relief");
  }
};

/// Vehicle that crosses the image periodically.
struct VehicleConfig {
  double image_share = 0.04;
  double crossing_s = 15;

  static void fields(auto& self, auto&& field) {
    field("image_share", self.image_share, Range{1e-4, 0.5}, "covered fraction of the image area");
    field("crossing_s", self.crossing_s, kPositive, "time to cross the image");
  }
};

struct SimulationConfig {
  int seed = 1;
  FlightCameraConfig camera{};
  FlightConfig flight{};
  GroundConfig ground{};
  std::optional<VehicleConfig> vehicle{};
  ImuConfig imu{};
  RangeConfig range{};

  static void fields(auto& self, auto&& field) {
    field("seed", self.seed, kAnySeed, "seed of all random numbers");
    field("camera", self.camera, "lens, sensor and mount");
    field("flight", self.flight, "trajectory");
    field("ground", self.ground, "texture and relief of the ground");
    field("vehicle", self.vehicle, "moving vehicle on the ground; null: none");
    field("imu", self.imu, "gyroscope and accelerometer");
    field("range", self.range, "range finder along -z of the body");
  }
};

}  // namespace stillkite
