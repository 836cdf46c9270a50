#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class Detector { shi_tomasi, fast, sift, orb };
template <>
struct EnumNames<Detector> {
  static constexpr auto value =
      std::to_array<std::pair<Detector, std::string_view>>({{Detector::shi_tomasi, "shi_tomasi"},
                                                            {Detector::fast, "fast"},
                                                            {Detector::sift, "sift"},
                                                            {Detector::orb, "orb"}});
};

/// Defaults: hold paper, section III.
struct DetectorConfig {
  Detector kind = Detector::shi_tomasi;
  int max_features = 3000;
  double quality = 0.01;
  double min_distance_px = 2;
  int block_px = 3;
  int fast_threshold = 20;

  static void fields(auto& self, auto&& field) {
    field("kind", self.kind, "feature detector; SURF (hold paper) is patented");
    field("max_features", self.max_features, Range{20, 20000},
          "maximum number of features, strongest first");
    field("quality", self.quality, Range{1e-6, 1},
          "shi_tomasi: minimum corner response as a ratio of the maximum");
    field("min_distance_px", self.min_distance_px, Range{0, 200},
          "shi_tomasi: minimum distance between corners");
    field("block_px", self.block_px, Range{2, 63},
          "shi_tomasi: side of the structure tensor's window");
    field("fast_threshold", self.fast_threshold, Range{1, 255},
          "fast: minimum grey difference on the circle");
  }
};

}  // namespace stillkite
