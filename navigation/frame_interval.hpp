#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "estimation/verdict.hpp"
#include "flow/frame.hpp"

namespace stillkite {

/// Standard deviations of a camera at rest, angles of the image.
struct StandstillSigma {
  double rate_rad_s = 0;    ///< of zero angular rate, and of zero velocity in heights/s
  double rotation_rad = 0;  ///< of the rotation since it came to rest, or of the shift in heights
};

/// Interval between two frames, and the checks that precede any motion estimation.
struct FrameInterval {
  double dt_s = 0;                   ///< since the previous frame; at least 1 ms
  std::optional<Verdict> rejection;  ///< first_frame, time_gap or frozen; empty: usable pair
  bool is_forward_gap = false;       ///< time_gap with an ascending stamp
  std::optional<StandstillSigma> standstill;  ///< camera at rest; empty otherwise
};

/// Compares the stamp and pixels of each frame with those of the previous one.
class FrameClock {
 public:
  explicit FrameClock(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// A repeated image that was encoded again is detected, too: the images before it changed much
  /// more, and no camera stops within a frame.
  FrameInterval check(const Frame& frame);

 private:
  [[nodiscard]] bool is_repeated(const cv::Mat& grey);

  double max_gap_s_;
  std::optional<Timestamp> last_stamp_;
  cv::Mat last_image_;                    // last one that was not frozen; shared with the source
  cv::Mat exposed_as_now_;                // buffer
  std::vector<double> displacements_px_;  // of the last accepted images, each to the one before
};

}  // namespace stillkite
