#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "geometry/time.hpp"

namespace stillkite {

class ImageMask;

/// One grey image of the camera, CV_8UC1. The pixels are shared, not copied.
struct Frame {
  Timestamp stamp;
  std::int64_t index = 0;  ///< of the frame in its source, rejected ones counted too
  cv::Mat grey;
  std::shared_ptr<const ImageMask> mask;  ///< none: all of it shows the world
};

}  // namespace stillkite
