#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "io/video/video_writer.hpp"
#include "simulation/flight/simulation_config.hpp"

namespace stillkite {

/// Format of the simulated images.
enum class ImageFormat { video, euroc };
template <>
struct EnumNames<ImageFormat> {
  static constexpr auto value = std::to_array<std::pair<ImageFormat, std::string_view>>(
      {{ImageFormat::video, "video"}, {ImageFormat::euroc, "euroc"}});
};

struct FlightOutputConfig {
  ImageFormat format = ImageFormat::video;
  EncoderConfig encoder{};

  static void fields(auto& self, auto&& field) {
    field("format", self.format, "video: one H.264 file; euroc: PNG images in EuRoC layout");
    field("encoder", self.encoder, "encoder of the video");
  }
};

/// Configuration of `stillkite simulate`.
struct SimulateConfig {
  SimulationConfig simulation{};
  FlightOutputConfig output{};

  static void fields(auto& self, auto&& field) {
    SimulationConfig::fields(self.simulation, field);
    field("output", self.output, "output files");
  }
};

}  // namespace stillkite
