#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "estimation/verdict.hpp"
#include "flow/frame.hpp"

namespace stillkite {

/// What is known of a frame before anyone looks at what it shows.
struct FrameInterval {
  double dt_s = 0;                 ///< since the frame before; at least a millisecond
  std::optional<Verdict> spoiled;  ///< first_frame, time_gap or frozen: there is no pair to compare
  bool is_late = false;            ///< a time_gap with the stamp ahead, not behind
};

/// Compares every frame's stamp and pixels with those of the frame before.
class FrameClock {
 public:
  explicit FrameClock(double max_gap_s) : max_gap_s_(max_gap_s) {}

  FrameInterval pass(const Frame& frame);

 private:
  double max_gap_s_;
  std::optional<Timestamp> last_stamp_;
  cv::Mat last_picture_;  // shared with the source
};

}  // namespace stillkite
