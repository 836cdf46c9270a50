#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Errors of the recorded time stamps. Truth and range finder have the exact clock.
struct ClockConfig {
  double image_delay_s = 0;
  double jitter_s = 0;
  double rounding_s = 0;
  double imu_offset_s = 0;
  double imu_skew_ppm = 0;

  static void fields(auto& self, auto&& field) {
    field("image_delay_s", self.image_delay_s, Range{0, 10},
          "constant latency from the exposure of an image to its stamp");
    field("jitter_s", self.jitter_s, Range{0, 10},
          "further latency of an image, exponentially distributed: mean and standard deviation");
    field("rounding_s", self.rounding_s, Range{0, 1},
          "resolution of the stamps of images and IMU; 0: 1 ns");
    field("imu_offset_s", self.imu_offset_s, Range{-10, 10},
          "offset of the IMU's stamps; imu.time_offset_s = image_delay_s + jitter_s - imu_offset_s "
          "compensates it in a run");
    field("imu_skew_ppm", self.imu_skew_ppm, Range{-1e5, 1e5},
          "relative rate error of the IMU's clock");
  }

  [[nodiscard]] bool has_exact_image_stamps() const {
    return image_delay_s == 0 && jitter_s == 0 && rounding_s == 0;
  }
};

/// Stamp of an image on its arrival: exposure + delay + exponential latency, rounded. Images arrive
/// in order, at least 1 ms apart, so that stamps ascend.
[[nodiscard]] std::vector<Timestamp> image_stamps(const ClockConfig& config,
                                                  const std::vector<Timestamp>& exposures,
                                                  std::uint64_t seed);

/// offset + (1 + skew) t, rounded.
[[nodiscard]] Timestamp imu_stamp(const ClockConfig& config, Timestamp exact);

}  // namespace stillkite
