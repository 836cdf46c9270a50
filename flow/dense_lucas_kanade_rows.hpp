#pragma once

#include <cstddef>
#include <cstdint>

namespace stillkite {

/// Vectors overrun the end of a row: every row of a `Rows` has this much room behind its width,
/// and an image one row more than its height. What is read there has no influence.
inline constexpr int kRowMargin = 64;

template <typename T>
struct Rows {
  T* data = nullptr;
  std::ptrdiff_t stride = 0;  // in T

  [[nodiscard]] T* row(int y) const { return data + y * stride; }
};

/// One step of DenseLucasKanade on one level: `flow` from `warp`. Flows interleave x and y.
struct DenseStep {
  int width = 0;
  int height = 0;
  Rows<const std::uint8_t> previous;
  Rows<const std::uint8_t> current;
  Rows<const float> warp;
  Rows<float> flow;
  Rows<float> information;  ///< null: not asked for
  int radius = 0;           ///< of the window: it has 2 radius + 1 pixels a side
  float regularisation = 0;
};

/// Floats that `step_rows` needs to work in, 64-byte aligned.
[[nodiscard]] std::size_t scratch_size(int width, int radius);

/// Writes the rows from `first` to before `end` of the flow and the information.
void step_rows(const DenseStep& step, int first, int end, float* scratch);

/// Flow of twice the size: fine(2x) = 2 coarse(x), linear between. Coarse has half the size rounded
/// up. `line` holds 2 (coarse width + kRowMargin) floats.
void upsample_flow(Rows<const float> coarse, int coarse_width, int coarse_height, Rows<float> fine,
                   int width, int height, float* line);

}  // namespace stillkite
