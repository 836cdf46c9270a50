#pragma once

#include <filesystem>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

/// The images of a run.
struct SourceConfig {
  std::filesystem::path path;
  double start_s = 0;
  std::optional<double> end_s;
  std::optional<double> rate_hz;
  std::optional<int> bits;

  static void fields(auto& self, auto&& field) {
    field("path", self.path, "a video, a EuRoC data set, or a folder of images");
    field("start_s", self.start_s, kNotNegative, "leave out what is before, from the first frame");
    field("end_s", self.end_s, kPositive, "leave out what is after");
    field("rate_hz", self.rate_hz, Range{1e-3, 1e5},
          "frames per second of images without stamps; replaces a video's own stamps");
    field("bits", self.bits, Range{8, 16},
          "of a pixel that are used, where image files of 16 bits hold 10, 12 or 14");
  }
};

}  // namespace stillkite
