#pragma once

#include <cstdint>

namespace stillkite {

/// One row of `develop`; the count is a multiple of kDevelopPadding.
struct DevelopRow {
  const float* irradiance = nullptr;
  std::uint8_t* grey = nullptr;
  int count = 0;
  std::uint32_t first_pixel = 0;  ///< its number in the image
  std::uint32_t key_1 = 0;        ///< of the image
  std::uint32_t key_2 = 0;
  float gain = 1;
  float noise_grey = 0;
};
inline constexpr int kDevelopPadding = 16;

/// With the widest vector instructions of this processor, chosen at run time.
void develop_row(const DevelopRow& row);

}  // namespace stillkite
