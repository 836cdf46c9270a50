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

  /// An image that was sent again may have been coded again, and differ a little. It is frozen
  /// where the images moved, by `speed_px_s` in the frame before (0: not known), and now do not,
  /// until they do.
  FrameInterval pass(const Frame& frame, double speed_px_s = 0);

 private:
  [[nodiscard]] bool is_sent_again(const cv::Mat& grey, double moved_px);

  double max_gap_s_;
  std::optional<Timestamp> last_stamp_;
  cv::Mat last_image_;   // that was not frozen; shared with the source
  double still_px_ = 0;  // while frozen: what shows less motion than this is so still
};

}  // namespace stillkite
