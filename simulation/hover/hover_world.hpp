#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>

#include "simulation/hover/hover_config.hpp"
#include "simulation/render/patch_renderer.hpp"

namespace stillkite {

/// What an image suffers between camera and computer; empty: nothing.
using VideoLink = std::function<cv::Mat(const cv::Mat& grey)>;

/// What all trials of one configuration share; making it takes longer than a frame.
struct HoverWorld {
  PatchScene scene;
  PatchRenderer renderer;
  VideoLink link;
};
[[nodiscard]] HoverWorld make_hover_world(const HoverConfig& config, VideoLink link = {});

}  // namespace stillkite
