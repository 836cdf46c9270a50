#pragma once

#include <string>

#include "geometry/camera.hpp"

namespace stillkite {

class ImageMask;

/// Throws InputError "origin: problem" unless the lens model is one-to-one over the image: from the
/// principal point to every unmasked pixel of the border the image radius increases with the angle
/// of incidence, up to 90 degrees. `mask` may be null.
void check_lens(const Camera& camera, const ImageMask* mask, const std::string& origin);

}  // namespace stillkite
