#include "navigation/frame_interval.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// Lower bound of dt for frames whose stamp does not ascend.
constexpr double kMinInterval_s = 1e-3;

bool same_image(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

cv::Mat subsample_rows(const cv::Mat& image) {
  constexpr int kEvery = 8;
  return {(image.rows + kEvery - 1) / kEvery, image.cols, image.type(), image.data,
          kEvery * image.step};
}

// Brightness change over image gradient: the mean displacement, valid up to one or two pixels.
double image_displacement_px(const cv::Mat& before, const cv::Mat& now) {
  const cv::Mat a = subsample_rows(before);
  const cv::Mat b = subsample_rows(now);
  const double gradient =
      cv::norm(b.colRange(2, b.cols), b.colRange(0, b.cols - 2), cv::NORM_L1) / 2;
  return gradient > 0 ? cv::norm(a, b, cv::NORM_L1) / gradient : HUGE_VAL;
}

}  // namespace

FrameInterval FrameClock::check(const Frame& frame, double speed_px_s) {
  FrameInterval out;
  if (!last_stamp_) {
    out.rejection = Verdict::first_frame;
  } else {
    const double dt_s = seconds_between(*last_stamp_, frame.stamp);
    out.dt_s = std::max(dt_s, kMinInterval_s);
    out.is_forward_gap = dt_s > max_gap_s_;
    if (dt_s <= 0 || out.is_forward_gap) {
      out.rejection = Verdict::time_gap;
    } else if (is_repeated(frame.grey, speed_px_s * dt_s)) {
      out.rejection = Verdict::frozen;
    }
  }
  last_stamp_ = last_stamp_ ? std::max(*last_stamp_, frame.stamp) : frame.stamp;
  if (out.rejection != Verdict::frozen) {
    last_image_ = frame.grey;
    frozen_below_px_ = 0;
  }
  return out;
}

// Motion above one pixel per frame does not stop within a frame. A repeated image measures 0.1 px
// after H.264 or MPEG-4, and 0.6 px if it is intra-coded.
bool FrameClock::is_repeated(const cv::Mat& grey, double expected_px) {
  constexpr double kMinDisplacement_px = 1;
  constexpr double kDisplacementRatio = 0.2;
  constexpr double kMaxFrozenDisplacement_px = 0.75;
  if (expected_px > kMinDisplacement_px) {
    frozen_below_px_ = std::max(
        frozen_below_px_, std::min(kDisplacementRatio * expected_px, kMaxFrozenDisplacement_px));
  }
  return same_image(grey, last_image_) ||
         (frozen_below_px_ > 0 && grey.cols > 2 &&
          image_displacement_px(last_image_, grey) < frozen_below_px_);
}

}  // namespace stillkite
