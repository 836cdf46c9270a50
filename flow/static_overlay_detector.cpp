#include "flow/static_overlay_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "flow/image_mask.hpp"

namespace stillkite {
namespace {

// Two images are compared once the image has moved by this, in mean.
constexpr double kMoved_px = 4;
// An edge: the sum of its slopes along x and y, grey a pixel of the half-size image.
constexpr int kEdge_grey = 30;
// It has kept still where its grey has changed by at most this part of its slope: a fifth of a
// pixel.
constexpr int kStillPart = 5;
// So many comparisons in which an edge was still make it fixed; one in which it was not halves what
// was counted, and this many are needed for it to stay so.
constexpr int kFixed = 12, kStaysFixed = 6, kMostCounted = 24;
constexpr int kCell_px = 4;  // side, in the half-size image
constexpr int kFewestPixels = 2;
// Least eigenvalue of the structure tensor over the largest: an edge that moves along itself looks
// still, a corner does not.
constexpr float kCorner = 0.1F;

// Of twice the gradient: xx, yy, xy.
cv::Vec3f tensor_at(const cv::Mat& image, int y, int x) {
  const std::uint8_t* row = image.ptr(y);
  const auto gx = static_cast<float>(row[x + 1] - row[x - 1]);
  const auto gy = static_cast<float>(image.ptr(y + 1)[x] - image.ptr(y - 1)[x]);
  return {gx * gx, gy * gy, gx * gy};
}

void for_each_cell(const cv::Mat& cells, auto&& visit) {
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) visit(row, column);
  }
}

// In the whole image.
cv::Rect cell_px(int row, int column) {
  constexpr int kSide_px = 2 * kCell_px;
  return {column * kSide_px, row * kSide_px, kSide_px, kSide_px};
}

// What hangs together and has a corner somewhere.
cv::Mat with_corners(const cv::Mat& cells, const cv::Mat& corners) {
  cv::Mat labels;
  const int count = cv::connectedComponents(cells, labels, 8, CV_32S);
  std::vector<unsigned char> has_corner(static_cast<std::size_t>(count), 0);
  for_each_cell(cells, [&](int row, int column) {
    if (corners.at<std::uint8_t>(row, column) == 0) return;
    has_corner[static_cast<std::size_t>(labels.at<int>(row, column))] = 255;
  });
  has_corner[0] = 0;  // the label of what is not fixed
  cv::Mat out(cells.size(), CV_8U);
  std::transform(labels.begin<int>(), labels.end<int>(), out.begin<std::uint8_t>(),
                 [&](int label) { return has_corner[static_cast<std::size_t>(label)]; });
  return out;
}

}  // namespace

Frame StaticOverlayDetector::masked(Frame frame) {
  if (!has_overlays_) return frame;
  if (!combined_ || given_ != frame.mask) {
    given_ = frame.mask;
    cv::Mat shows_world =
        given_ ? given_->shows_world().clone() : cv::Mat(frame.grey.size(), CV_8U, cv::Scalar(255));
    for_each_cell(cells_, [&](int row, int column) {
      if (cells_.at<std::uint8_t>(row, column) != 0) shows_world(cell_px(row, column)) = 0;
    });
    combined_ = std::make_shared<const ImageMask>(shows_world);
  }
  frame.mask = combined_;
  return frame;
}

void StaticOverlayDetector::learn(const cv::Mat& grey,
                                  const std::optional<Eigen::Vector2d>& shift_px) {
  const cv::Size half_size = grey.size() / 2;
  if (std::min(half_size.width, half_size.height) < kCell_px) return;
  const bool begins = !shift_px || before_.size() != half_size;
  if (!begins) since_then_px_ += *shift_px;
  if (!begins && since_then_px_.norm() < kMoved_px) return;
  cv::resize(grey, half_, half_size, 0, 0, cv::INTER_AREA);
  if (!begins) {
    count_still();
    const cv::Mat cells = fixed_cells();
    if (cv::norm(cells, cells_, cv::NORM_INF) > 0) combined_.reset();
    cells_ = cells;
    has_overlays_ = cv::countNonZero(cells_) > 0;
  } else if (counts_.size() != half_size) {
    counts_ = cv::Mat::zeros(half_size, CV_8U);
    cells_ = cv::Mat::zeros(half_size / kCell_px, CV_8U);
  }
  std::swap(before_, half_);
  since_then_px_.setZero();
}

void StaticOverlayDetector::count_still() {
  for (int y = 1; y + 1 < half_.rows; ++y) {
    std::uint8_t* count = counts_.ptr(y);
    const std::uint8_t* now = half_.ptr(y);
    const std::uint8_t* above = half_.ptr(y - 1);
    const std::uint8_t* below = half_.ptr(y + 1);
    const std::uint8_t* then = before_.ptr(y);
    for (int x = 1; x + 1 < half_.cols; ++x) {
      const int slope = std::abs(now[x + 1] - now[x - 1]) + std::abs(below[x] - above[x]);
      const bool is_still =
          slope >= 2 * kEdge_grey && 2 * kStillPart * std::abs(now[x] - then[x]) <= slope;
      count[x] =
          static_cast<std::uint8_t>(is_still ? std::min(count[x] + 1, kMostCounted) : count[x] / 2);
    }
  }
}

cv::Mat StaticOverlayDetector::fixed_cells() const {
  cv::Mat fixed = cv::Mat::zeros(cells_.size(), CV_8U);
  const cv::Mat may_be_fixed = counts_ >= kStaysFixed;
  if (cv::countNonZero(may_be_fixed) == 0) return fixed;
  cv::Mat tensors = cv::Mat::zeros(cells_.size(), CV_32FC3);
  for_each_cell(cells_, [&](int row, int column) {
    const int enough = cells_.at<std::uint8_t>(row, column) != 0 ? kStaysFixed : kFixed;
    cv::Vec3f& tensor = tensors.at<cv::Vec3f>(row, column);
    int pixels = 0;
    for (int y = row * kCell_px; y < (row + 1) * kCell_px; ++y) {
      for (int x = column * kCell_px; x < (column + 1) * kCell_px; ++x) {
        if (counts_.at<std::uint8_t>(y, x) < enough) continue;
        ++pixels;
        tensor += tensor_at(half_, y, x);
      }
    }
    if (pixels >= kFewestPixels) fixed.at<std::uint8_t>(row, column) = 255;
  });
  cv::boxFilter(tensors, tensors, -1, {3, 3}, {-1, -1}, false);
  cv::Mat corners = cv::Mat::zeros(cells_.size(), CV_8U);
  for_each_cell(cells_, [&](int row, int column) {
    const cv::Vec3f& t = tensors.at<cv::Vec3f>(row, column);
    const float sum = t[0] + t[1];
    const float spread = std::hypot(t[0] - t[1], 2 * t[2]);
    const bool is_corner = sum - spread > kCorner * (sum + spread);
    if (is_corner) corners.at<std::uint8_t>(row, column) = fixed.at<std::uint8_t>(row, column);
  });
  return with_corners(fixed, corners);
}

}  // namespace stillkite
