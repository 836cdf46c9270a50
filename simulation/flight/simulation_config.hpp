#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "simulation/flight/camera_config.hpp"
#include "simulation/flight/clock.hpp"
#include "simulation/flight/flight.hpp"
#include "simulation/flight/flight_imu_config.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite {

enum class FlightScene { ground, room, coast };

template <>
struct EnumNames<FlightScene> {
  static constexpr auto value =
      std::to_array<std::pair<FlightScene, std::string_view>>({{FlightScene::ground, "ground"},
                                                               {FlightScene::room, "room"},
                                                               {FlightScene::coast, "coast"}});
};

struct GroundConfig {
  std::optional<std::filesystem::path> photograph{};
  std::optional<double> metres_per_texel{};
  int side_texels = 4096;
  std::optional<double> period_m{};
  ReliefConfig relief{};

  static void fields(auto& self, auto&& field) {
    field("photograph", self.photograph, "aerial image of the ground; null: procedural texture");
    field("metres_per_texel", self.metres_per_texel, kPositive,
          "texel size on the ground; null: 0.8 pixel footprints at the initial height");
    field("side_texels", self.side_texels, Range{64, 16384},
          "side length of the procedural texture, which repeats mirrored");
    field("period_m", self.period_m, kPositive,
          "repetitive texture: exact period along x and y, an even number of texels, whose size is "
          "adjusted; null: none");
    field("relief", self.relief, "terrain relief");
  }

  /// Even number of texels nearest to the period.
  [[nodiscard]] int period_texels(double texel_m) const {
    return 2 * std::max(2, static_cast<int>(std::lround(0.5 * *period_m / texel_m)));
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

/// Shadow of the aircraft on the ground.
struct AircraftShadowConfig {
  double size_m = 1;
  double darkening_ratio = 0.7;
  double sun_elevation_deg = 50;
  double sun_azimuth_deg = 0;

  static void fields(auto& self, auto&& field) {
    field("size_m", self.size_m, kPositive, "diameter of the aircraft");
    field("darkening_ratio", self.darkening_ratio, Range{0, 1},
          "share of the direct sun in the light of the ground");
    field("sun_elevation_deg", self.sun_elevation_deg, Range{5, 90},
          "elevation of the sun over the horizon");
    field("sun_azimuth_deg", self.sun_azimuth_deg, kAny,
          "direction to the sun, from +x towards +y of the world");
  }
};

struct SimulationConfig {
  int seed = 1;
  FlightScene scene = FlightScene::ground;
  FlightCameraConfig camera{};
  FlightConfig flight{};
  GroundConfig ground{};
  std::optional<VehicleConfig> vehicle{};
  std::optional<AircraftShadowConfig> shadow{};
  FlightImuConfig imu{};
  RangeConfig range{};
  ClockConfig clock{};

  static void fields(auto& self, auto&& field) {
    field("seed", self.seed, kAnySeed, "seed of all random numbers");
    field("scene", self.scene,
          "ground: keys of ground, vehicle, shadow; room: 12 x 10 x 4 m, origin at the floor's "
          "centre; coast: from a boat at the origin; range finder over ground only");
    field("camera", self.camera, "lens, sensor and mount");
    field("flight", self.flight, "trajectory");
    field("ground", self.ground, "texture and relief of the ground");
    field("vehicle", self.vehicle, "moving vehicle on the ground; null: none");
    field("shadow", self.shadow, "shadow of the aircraft on the ground; null: none");
    field("imu", self.imu, "gyroscope and accelerometer; a reading is the value at its stamp");
    field("range", self.range, "range finder along -z of the body");
    field("clock", self.clock, "errors of the time stamps");
  }
};

}  // namespace stillkite
