#include "io/video/picture_pool.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// Other threads drop their references while this looks: read the count as they write it.
bool is_held_by_pool_alone(const cv::Mat& picture) {
  return picture.u != nullptr && CV_XADD(&picture.u->refcount, 0) == 1;
}

}  // namespace

cv::Mat PicturePool::take() const {
  const auto free = std::find_if(pictures_.begin(), pictures_.end(), is_held_by_pool_alone);
  return free == pictures_.end() ? cv::Mat() : *free;
}

void PicturePool::keep(const cv::Mat& picture) {
  const auto same = [&](const cv::Mat& known) { return known.u == picture.u; };
  if (std::none_of(pictures_.begin(), pictures_.end(), same)) pictures_.push_back(picture);
}

}  // namespace stillkite
