#pragma once

#include <string>

#include "geometry/camera.hpp"

namespace stillkite {

/// Throws InputError "origin: problem" unless resolution and focal lengths are positive, the focal
/// lengths at least 10 % of the image, the principal point inside it and all numbers finite, and if
/// the intrinsics are plausible only in another order (fu, cu, fv, cv).
void check_camera(const Camera& camera, const std::string& origin);

}  // namespace stillkite
