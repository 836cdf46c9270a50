#pragma once

#include <filesystem>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

/// Image source of a run.
struct SourceConfig {
  std::filesystem::path path;
  double start_s = 0;
  std::optional<double> end_s;
  std::optional<double> rate_hz;
  std::optional<int> bits;
  std::optional<int> track;

  static void fields(auto& self, auto&& field) {
    field("path", self.path, "video, EuRoC data set, or folder of images");
    field("start_s", self.start_s, kNonNegative, "start time after the first frame");
    field("end_s", self.end_s, kPositive, "end time after the first frame");
    field("rate_hz", self.rate_hz, Range{1e-3, 1e5},
          "frame rate for images without time stamps; replaces those of a video or EuRoC data set");
    field("bits", self.bits, Range{8, 16},
          "significant bits per pixel of images and videos of more than 8 bits, for example 10, 12 "
          "or 14");
    field("track", self.track, Range{0, 99},
          "number of the video track, from 0; default: the one that FFmpeg ranks first");
  }
};

}  // namespace stillkite
