#pragma once

#include <cstddef>
#include <cstdint>

namespace stillkite {

/// Padding behind each row of a `Rows`, in elements: SIMD loads overrun the row. Images have one
/// row of padding as well. Padding values do not affect the result.
inline constexpr int kRowMargin = 64;

template <typename T>
struct Rows {
  T* data = nullptr;
  std::ptrdiff_t stride = 0;  // in T

  [[nodiscard]] T* row(int y) const { return data + y * stride; }
};

/// One iteration of DenseLucasKanade on one level: `flow` from `warp`, x and y interleaved.
struct DenseStep {
  int width = 0;
  int height = 0;
  Rows<const std::uint8_t> previous;
  Rows<const std::uint8_t> current;
  Rows<const float> warp;
  Rows<float> flow;
  Rows<float> information;  ///< null: not computed
  int radius = 0;           ///< half side of the window: (2 radius + 1)^2 px
  float regularisation = 0;
};

/// Number of floats of the 64-byte aligned scratch buffer of `step_rows`.
[[nodiscard]] std::size_t scratch_size(int width, int radius);

/// Writes rows [first, end) of the flow and the information.
void step_rows(const DenseStep& step, int first, int end, float* scratch);

/// Linear upsampling of a flow by two: fine(2x) = 2 coarse(x). The coarse size is half the fine
/// size, rounded up. `line`: scratch of 2 (coarse width + kRowMargin) floats.
void upsample_flow(Rows<const float> coarse, int coarse_width, int coarse_height, Rows<float> fine,
                   int width, int height, float* line);

}  // namespace stillkite
