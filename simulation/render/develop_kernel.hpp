#pragma once

#include <cstdint>

namespace stillkite {

/// One row of `develop`.
struct DevelopRow {
  const float* irradiance = nullptr;
  std::uint8_t* grey = nullptr;
  int count = 0;                  ///< multiple of kDevelopPadding
  std::uint32_t first_pixel = 0;  ///< index in the image
  std::uint32_t key_1 = 0;        ///< noise key of the image
  std::uint32_t key_2 = 0;
  float gain = 1;
  float noise_grey = 0;
  float photon_variance_per_grey = 0;
};
inline constexpr int kDevelopPadding = 16;

/// Dispatches at run time to the widest vector instructions of the processor.
void develop_row(const DevelopRow& row);

}  // namespace stillkite
