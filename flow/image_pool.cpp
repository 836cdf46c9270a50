#include "flow/image_pool.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// Atomic read of the reference count, which other threads decrement.
bool is_held_by_pool_alone(const cv::Mat& image) {
  return image.u != nullptr && CV_XADD(&image.u->refcount, 0) == 1;
}

}  // namespace

cv::Mat ImagePool::take() const {
  const auto free = std::find_if(images_.begin(), images_.end(), is_held_by_pool_alone);
  return free == images_.end() ? cv::Mat() : *free;
}

void ImagePool::keep(const cv::Mat& image) {
  const auto is_same = [&](const cv::Mat& kept) { return kept.u == image.u; };
  if (std::none_of(images_.begin(), images_.end(), is_same)) images_.push_back(image);
}

}  // namespace stillkite
