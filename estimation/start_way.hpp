#pragma once

#include <functional>
#include <span>
#include <vector>

#include "estimation/fusion_config.hpp"
#include "estimation/landmark_view.hpp"

namespace stillkite {

class FusionFilter;

/// What a filter was told up to a frame, and what it believed of that frame.
struct ToldFrame {
  std::vector<std::function<void(FusionFilter&)>> told;
  std::vector<FeatureView> seen;
};

/// World from camera, a frame each.
using StartWay = std::vector<RigidTransform>;

/// The camera's way through a start, if the landmarks were where they are said to be: each frame's
/// resection measures its pose, and a filter without landmarks that is told all else is smoothed
/// (Rauch, Tung, Striebel 1965).
[[nodiscard]] StartWay smoothed_way(const FusionConfig& config, const FusionStart& start,
                                    std::span<const ToldFrame> frames,
                                    const std::vector<Landmark>& landmarks);

}  // namespace stillkite
