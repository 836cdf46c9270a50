#pragma once

namespace stillkite {

/// How much later than the middle row, seconds, a row is exposed by a camera that takes
/// `readout_s` for all of them.
[[nodiscard]] constexpr double row_time_s(double readout_s, double row_px, int height_px) {
  return readout_s * (row_px - 0.5 * (height_px - 1)) / height_px;
}

}  // namespace stillkite
