#include "navigation/frame_interval.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

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

// Ratio of the mean changes from image to image and from column to column, independent of
// exposure: the mean displacement, valid up to one or two pixels and bounded beyond. Infinite for a
// uniform image.
double image_displacement_px(const cv::Mat& before, const cv::Mat& now, cv::Mat& exposed_as_now) {
  const cv::Mat a = subsample_rows(before);
  const cv::Mat b = subsample_rows(now);
  cv::Scalar mean_a, mean_b, sigma_a, sigma_b;
  cv::meanStdDev(a, mean_a, sigma_a);
  cv::meanStdDev(b, mean_b, sigma_b);
  const double gain = sigma_a[0] > 0 ? sigma_b[0] / sigma_a[0] : 1;
  a.convertTo(exposed_as_now, CV_8U, gain, mean_b[0] - gain * mean_a[0]);
  const double gradient =
      cv::norm(b.colRange(2, b.cols), b.colRange(0, b.cols - 2), cv::NORM_L1) / 2;
  return gradient > 0 ? cv::norm(exposed_as_now, b, cv::NORM_L1) / gradient : HUGE_VAL;
}

// Displacement of the next image at constant acceleration, and at least the third largest of the
// last ones: a flash changes two images, and repeated images may have been accepted. 0: unknown.
double expected_displacement_px(const std::vector<double>& last_px) {
  if (last_px.size() < 3) return 0;
  std::vector<double> sorted_px = last_px;
  std::nth_element(sorted_px.begin(), sorted_px.begin() + 2, sorted_px.end(), std::greater<>());
  const double extrapolated_px = 2 * last_px.back() - last_px[last_px.size() - 2];
  return std::min({sorted_px[2], last_px.back(), extrapolated_px});
}

}  // namespace

FrameInterval FrameClock::check(const Frame& frame) {
  FrameInterval out;
  if (!last_stamp_) {
    out.rejection = Verdict::first_frame;
  } else {
    const double dt_s = seconds_between(*last_stamp_, frame.stamp);
    out.dt_s = std::max(dt_s, kMinInterval_s);
    out.is_forward_gap = dt_s > max_gap_s_;
    if (dt_s <= 0 || out.is_forward_gap) {
      out.rejection = Verdict::time_gap;
    } else if (is_repeated(frame.grey)) {
      out.rejection = Verdict::frozen;
    }
  }
  last_stamp_ = last_stamp_ ? std::max(*last_stamp_, frame.stamp) : frame.stamp;
  if (out.rejection != Verdict::frozen) last_image_ = frame.grey;
  return out;
}

// Motion above one pixel per frame does not stop within a frame. A repeated image measures 0.1 px
// after H.264 or MPEG-4, and 0.6 px if it is intra-coded.
bool FrameClock::is_repeated(const cv::Mat& grey) {
  constexpr double kMinDisplacement_px = 1;
  constexpr double kDisplacementRatio = 0.2;
  constexpr double kMaxFrozenDisplacement_px = 0.75;
  constexpr std::size_t kDisplacements = 8;
  if (same_image(grey, last_image_)) return true;
  if (grey.size() != last_image_.size() || grey.cols <= 2) return false;
  const double displacement_px = image_displacement_px(last_image_, grey, exposed_as_now_);
  if (!std::isfinite(displacement_px)) {
    displacements_px_.clear();
    return false;
  }
  const double expected_px = expected_displacement_px(displacements_px_);
  if (expected_px > kMinDisplacement_px &&
      displacement_px < std::min(kDisplacementRatio * expected_px, kMaxFrozenDisplacement_px)) {
    return true;
  }
  if (displacements_px_.size() == kDisplacements)
    displacements_px_.erase(displacements_px_.begin());
  displacements_px_.push_back(displacement_px);
  return false;
}

}  // namespace stillkite
