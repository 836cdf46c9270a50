#include "io/video/interlacing.hpp"

#include <opencv2/core.hpp>

namespace stillkite {

std::optional<Field> first_field(const AVFrame& image, AVFieldOrder track_order) {
  if (image.interlaced_frame != 0) return image.top_field_first != 0 ? Field::top : Field::bottom;
  switch (track_order) {  // codecs without a flag in each image
    case AV_FIELD_TT:
    case AV_FIELD_BT:
      return Field::top;
    case AV_FIELD_BB:
    case AV_FIELD_TB:
      return Field::bottom;
    default:
      return std::nullopt;
  }
}

void interpolate_other_field(cv::Mat& grey, Field kept) {
  if (grey.rows < 2) return;
  for (int row = kept == Field::top ? 1 : 0; row < grey.rows; row += 2) {
    const int above = row > 0 ? row - 1 : row + 1;
    const int below = row + 1 < grey.rows ? row + 1 : row - 1;
    const unsigned char* a = grey.ptr(above);
    const unsigned char* b = grey.ptr(below);
    unsigned char* mean = grey.ptr(row);
    for (int x = 0; x < grey.cols; ++x) mean[x] = static_cast<unsigned char>((a[x] + b[x] + 1) / 2);
  }
}

}  // namespace stillkite
