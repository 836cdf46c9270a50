#include "navigation/frame_interval.hpp"

#include <cstring>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// A frame whose stamp is not later than the last one's was still taken at some other instant.
constexpr double kLeastInterval_s = 1e-3;

bool same_picture(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

}  // namespace

FrameInterval FrameClock::pass(const Frame& frame) {
  FrameInterval out;
  if (!last_stamp_) {
    out.spoiled = Verdict::first_frame;
  } else {
    const double dt_s = seconds_between(*last_stamp_, frame.stamp);
    out.dt_s = std::max(dt_s, kLeastInterval_s);
    out.is_late = dt_s > max_gap_s_;
    if (dt_s <= 0 || out.is_late) {
      out.spoiled = Verdict::time_gap;
    } else if (same_picture(frame.grey, last_picture_)) {
      out.spoiled = Verdict::frozen;
    }
  }
  last_stamp_ = last_stamp_ ? std::max(*last_stamp_, frame.stamp) : frame.stamp;
  last_picture_ = frame.grey;
  return out;
}

}  // namespace stillkite
