#pragma once

#include <cstddef>
#include <cstdint>

namespace stillkite {

/// 8-bit grey image in the caller's memory, rows from top to bottom.
struct ImageView {
  const std::uint8_t* data = nullptr;  ///< pixel (0, 0)
  int width = 0;                       ///< px
  int height = 0;                      ///< px
  std::ptrdiff_t stride = 0;           ///< bytes from a row to the next, at least `width`
};

}  // namespace stillkite
