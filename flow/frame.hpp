#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "geometry/time.hpp"

namespace stillkite {

class ImageMask;

/// One grey camera image, CV_8UC1. Pixels are shared, not copied.
struct Frame {
  Timestamp stamp;
  std::int64_t index = 0;  ///< in the source, counting rejected frames
  cv::Mat grey;
  std::shared_ptr<const ImageMask> mask;  ///< null: all pixels are valid
  double stamp_sigma_s = 0;               ///< jitter of the stamp, as FilteredStamp::sigma_s
  Timestamp recorded_stamp{};             ///< of the source, before StampFilter
};

}  // namespace stillkite
