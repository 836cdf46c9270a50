#include "flow/frame_copies.hpp"

#include <fmt/format.h>

#include <string>

#include "flow/image_mask.hpp"
#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// cv::Mat has no view of constant pixels; the result is only read.
const cv::Mat matrix_of(const ImageView& image, int width_px, int height_px,
                        const std::string& name) {
  if (image.data == nullptr) throw InputError(fmt::format("{}: no pixels, data is null", name));
  if (image.width != width_px || image.height != height_px) {
    throw InputError(fmt::format("{}: {}x{} pixels; the camera needs {}x{}", name, image.width,
                                 image.height, width_px, height_px));
  }
  if (image.stride < image.width) {
    throw InputError(fmt::format("{}: stride {} bytes; a row of {} pixels needs at least {}", name,
                                 image.stride, image.width, image.width));
  }
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

}  // namespace

FrameCopies::FrameCopies(const Camera& camera, const std::optional<ImageView>& valid_pixels)
    : width_px_(camera.width_px), height_px_(camera.height_px) {
  if (!valid_pixels) return;
  mask_ = std::make_shared<const ImageMask>(
      matrix_of(*valid_pixels, width_px_, height_px_, "image mask").clone());
}

Frame FrameCopies::copy(const ImageView& image, Timestamp stamp) {
  const cv::Mat view =
      matrix_of(image, width_px_, height_px_, fmt::format("image {}", next_index_));
  cv::Mat grey = pool_.take();
  view.copyTo(grey);
  pool_.keep(grey);
  return {.stamp = stamp, .index = next_index_++, .grey = grey, .mask = mask_};
}

}  // namespace stillkite
