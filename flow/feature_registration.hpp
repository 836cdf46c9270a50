#pragma once

#include <optional>

#include "flow/patch_alignment.hpp"

namespace stillkite {

/// Registers the whole current image to the reference and aligns the features from the candidates;
/// keeps the alignment with the most features found, which may be the present one.
/// `image_rotation_rad`: as FeatureTracker::track.
void register_lost_features(PatchAlignment& alignment, std::optional<double> image_rotation_rad);

}  // namespace stillkite
