#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "estimation/verdict.hpp"
#include "flow/frame.hpp"

namespace stillkite {

/// Interval between two frames, and the checks that precede any motion estimation.
struct FrameInterval {
  double dt_s = 0;                   ///< since the previous frame; at least 1 ms
  std::optional<Verdict> rejection;  ///< first_frame, time_gap or frozen; empty: usable pair
  bool is_forward_gap = false;       ///< time_gap with an ascending stamp
};

/// Compares the stamp and pixels of each frame with those of the previous one.
class FrameClock {
 public:
  explicit FrameClock(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// `speed_px_s`: image speed of the previous frame; 0: not measured. With it, a repeated image
  /// that was encoded again is detected, too: it is frozen if the expected motion is absent.
  FrameInterval check(const Frame& frame, double speed_px_s = 0);

 private:
  [[nodiscard]] bool is_repeated(const cv::Mat& grey, double expected_px);

  double max_gap_s_;
  std::optional<Timestamp> last_stamp_;
  cv::Mat last_image_;          // last one that was not frozen; shared with the source
  double frozen_below_px_ = 0;  // displacement threshold while frozen; 0: inactive
};

}  // namespace stillkite
