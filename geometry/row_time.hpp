#pragma once

namespace stillkite {

/// Rolling shutter: exposure time of a row relative to the middle row, s. `readout_s`: readout time
/// of the whole frame.
[[nodiscard]] constexpr double row_time_offset_s(double readout_s, double row_px, int height_px) {
  return readout_s * (row_px - 0.5 * (height_px - 1)) / height_px;
}

}  // namespace stillkite
