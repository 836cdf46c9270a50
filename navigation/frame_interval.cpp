#include "navigation/frame_interval.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// A frame whose stamp is not later than the last one's was still taken at some other instant.
constexpr double kLeastInterval_s = 1e-3;

bool same_image(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

cv::Mat every_eighth_row(const cv::Mat& image) {
  constexpr int kEvery = 8;
  return {(image.rows + kEvery - 1) / kEvery, image.cols, image.type(), image.data,
          kEvery * image.step};
}

// What an image has changed by over its slope: the way that it has moved, up to a pixel or two.
double shown_px(const cv::Mat& before, const cv::Mat& now) {
  const cv::Mat a = every_eighth_row(before);
  const cv::Mat b = every_eighth_row(now);
  const double slope = cv::norm(b.colRange(2, b.cols), b.colRange(0, b.cols - 2), cv::NORM_L1) / 2;
  return slope > 0 ? cv::norm(a, b, cv::NORM_L1) / slope : HUGE_VAL;
}

}  // namespace

FrameInterval FrameClock::pass(const Frame& frame, double speed_px_s) {
  FrameInterval out;
  if (!last_stamp_) {
    out.spoiled = Verdict::first_frame;
  } else {
    const double dt_s = seconds_between(*last_stamp_, frame.stamp);
    out.dt_s = std::max(dt_s, kLeastInterval_s);
    out.is_late = dt_s > max_gap_s_;
    if (dt_s <= 0 || out.is_late) {
      out.spoiled = Verdict::time_gap;
    } else if (is_sent_again(frame.grey, speed_px_s * dt_s)) {
      out.spoiled = Verdict::frozen;
    }
  }
  last_stamp_ = last_stamp_ ? std::max(*last_stamp_, frame.stamp) : frame.stamp;
  if (out.spoiled != Verdict::frozen) {
    last_image_ = frame.grey;
    still_px_ = 0;
  }
  return out;
}

// What moves by more than a pixel a frame does not stop within one. An image that is sent again
// shows 0.1 px after H.264 or MPEG-4, and 0.6 where it is coded by itself.
bool FrameClock::is_sent_again(const cv::Mat& grey, double moved_px) {
  constexpr double kLeastMoved_px = 1;
  constexpr double kShare = 0.2;
  constexpr double kMostStill_px = 0.75;
  if (moved_px > kLeastMoved_px) {
    still_px_ = std::max(still_px_, std::min(kShare * moved_px, kMostStill_px));
  }
  return same_image(grey, last_image_) ||
         (still_px_ > 0 && grey.cols > 2 && shown_px(last_image_, grey) < still_px_);
}

}  // namespace stillkite
