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

// Mean image displacement between two compared images.
constexpr double kMinImageShift_px = 4;
// Edge: |dI/dx| + |dI/dy| at half resolution, grey/px.
constexpr int kMinGradient_grey = 30;
// Static edge: |I - I'| <= gradient / kInverseMaxShift, to first order a displacement below 0.2 px.
constexpr int kInverseMaxShift = 5;
// Number of static comparisons required to detect an overlay, to keep it, and at most. A moving
// edge halves the count.
constexpr int kMinStaticCount = 12, kMinStaticCountToKeep = 6, kMaxStaticCount = 24;
constexpr int kCell_px = 4;  // side, at half resolution
constexpr int kMinPixelsPerCell = 2;
// Corner: ratio of the structure tensor's eigenvalues. A straight edge that moves along itself
// appears static.
constexpr float kMinEigenvalueRatio = 0.1F;

// Outer product of twice the gradient: xx, yy, xy.
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

// Rectangle of a cell at full resolution.
cv::Rect cell_px(int row, int column) {
  constexpr int kSide_px = 2 * kCell_px;
  return {column * kSide_px, row * kSide_px, kSide_px, kSide_px};
}

// Connected components that contain a corner.
cv::Mat components_with_corner(const cv::Mat& cells, const cv::Mat& corners) {
  cv::Mat labels;
  const int count = cv::connectedComponents(cells, labels, 8, CV_32S);
  std::vector<unsigned char> has_corner(static_cast<std::size_t>(count), 0);
  for_each_cell(cells, [&](int row, int column) {
    if (corners.at<std::uint8_t>(row, column) == 0) return;
    has_corner[static_cast<std::size_t>(labels.at<int>(row, column))] = 255;
  });
  has_corner[0] = 0;  // background
  cv::Mat out(cells.size(), CV_8U);
  std::transform(labels.begin<int>(), labels.end<int>(), out.begin<std::uint8_t>(),
                 [&](int label) { return has_corner[static_cast<std::size_t>(label)]; });
  return out;
}

}  // namespace

Frame StaticOverlayDetector::masked(Frame frame) {
  if (!has_overlays_) return frame;
  if (!combined_mask_ || input_mask_ != frame.mask) {
    input_mask_ = frame.mask;
    cv::Mat valid_pixels = input_mask_ ? input_mask_->valid_pixels().clone()
                                       : cv::Mat(frame.grey.size(), CV_8U, cv::Scalar(255));
    for_each_cell(overlay_cells_, [&](int row, int column) {
      if (overlay_cells_.at<std::uint8_t>(row, column) != 0) valid_pixels(cell_px(row, column)) = 0;
    });
    combined_mask_ = std::make_shared<const ImageMask>(valid_pixels);
  }
  frame.mask = combined_mask_;
  return frame;
}

void StaticOverlayDetector::update(const cv::Mat& grey,
                                   const std::optional<Eigen::Vector2d>& shift_px) {
  const cv::Size half_size = grey.size() / 2;
  if (std::min(half_size.width, half_size.height) < kCell_px) return;
  const bool is_first = !shift_px || reference_half_.size() != half_size;
  if (!is_first) accumulated_shift_px_ += *shift_px;
  if (!is_first && accumulated_shift_px_.norm() < kMinImageShift_px) return;
  cv::resize(grey, current_half_, half_size, 0, 0, cv::INTER_AREA);
  if (!is_first) {
    count_static_edges();
    const cv::Mat cells = static_cells();
    if (cv::norm(cells, overlay_cells_, cv::NORM_INF) > 0) combined_mask_.reset();
    overlay_cells_ = cells;
    has_overlays_ = cv::countNonZero(overlay_cells_) > 0;
  } else if (static_counts_.size() != half_size) {
    static_counts_ = cv::Mat::zeros(half_size, CV_8U);
    overlay_cells_ = cv::Mat::zeros(half_size / kCell_px, CV_8U);
  }
  std::swap(reference_half_, current_half_);
  accumulated_shift_px_.setZero();
}

void StaticOverlayDetector::count_static_edges() {
  for (int y = 1; y + 1 < current_half_.rows; ++y) {
    std::uint8_t* count = static_counts_.ptr(y);
    const std::uint8_t* current = current_half_.ptr(y);
    const std::uint8_t* above = current_half_.ptr(y - 1);
    const std::uint8_t* below = current_half_.ptr(y + 1);
    const std::uint8_t* reference = reference_half_.ptr(y);
    for (int x = 1; x + 1 < current_half_.cols; ++x) {
      const int gradient =
          std::abs(current[x + 1] - current[x - 1]) + std::abs(below[x] - above[x]);
      const bool is_static = gradient >= 2 * kMinGradient_grey &&
                             2 * kInverseMaxShift * std::abs(current[x] - reference[x]) <= gradient;
      count[x] = static_cast<std::uint8_t>(is_static ? std::min(count[x] + 1, kMaxStaticCount)
                                                     : count[x] / 2);
    }
  }
}

cv::Mat StaticOverlayDetector::static_cells() const {
  cv::Mat is_overlay = cv::Mat::zeros(overlay_cells_.size(), CV_8U);
  const cv::Mat candidates = static_counts_ >= kMinStaticCountToKeep;
  if (cv::countNonZero(candidates) == 0) return is_overlay;
  cv::Mat tensors = cv::Mat::zeros(overlay_cells_.size(), CV_32FC3);
  for_each_cell(overlay_cells_, [&](int row, int column) {
    const int min_count =
        overlay_cells_.at<std::uint8_t>(row, column) != 0 ? kMinStaticCountToKeep : kMinStaticCount;
    cv::Vec3f& tensor = tensors.at<cv::Vec3f>(row, column);
    int pixels = 0;
    for (int y = row * kCell_px; y < (row + 1) * kCell_px; ++y) {
      for (int x = column * kCell_px; x < (column + 1) * kCell_px; ++x) {
        if (static_counts_.at<std::uint8_t>(y, x) < min_count) continue;
        ++pixels;
        tensor += tensor_at(current_half_, y, x);
      }
    }
    if (pixels >= kMinPixelsPerCell) is_overlay.at<std::uint8_t>(row, column) = 255;
  });
  cv::boxFilter(tensors, tensors, -1, {3, 3}, {-1, -1}, false);
  cv::Mat corners = cv::Mat::zeros(overlay_cells_.size(), CV_8U);
  for_each_cell(overlay_cells_, [&](int row, int column) {
    const cv::Vec3f& t = tensors.at<cv::Vec3f>(row, column);
    const float sum = t[0] + t[1];
    const float spread = std::hypot(t[0] - t[1], 2 * t[2]);
    const bool is_corner = sum - spread > kMinEigenvalueRatio * (sum + spread);
    if (is_corner) corners.at<std::uint8_t>(row, column) = is_overlay.at<std::uint8_t>(row, column);
  });
  return components_with_corner(is_overlay, corners);
}

}  // namespace stillkite
