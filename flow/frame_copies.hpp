#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "flow/frame.hpp"
#include "flow/image_pool.hpp"
#include "geometry/camera.hpp"
#include "geometry/image_view.hpp"

namespace stillkite {

/// Frames whose pixels are copies, since a keyframe outlives the caller's capture buffer.
class FrameCopies {
 public:
  /// `valid_pixels`: mask of every frame, 0 where a pixel does not show the scene; copied.
  /// Throws InputError if it is not an image of the camera's size.
  FrameCopies(const Camera& camera, const std::optional<ImageView>& valid_pixels);

  /// Frame with the next index, from 0. Throws InputError unless the image has the camera's size.
  [[nodiscard]] Frame copy(const ImageView& image, Timestamp stamp);

 private:
  int width_px_;
  int height_px_;
  std::shared_ptr<const ImageMask> mask_;
  ImagePool pool_;
  std::int64_t next_index_ = 0;
};

}  // namespace stillkite
