#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>

#include "simulation/hover/hover_config.hpp"
#include "simulation/render/patch_renderer.hpp"

namespace stillkite {

/// Image degradation between camera and computer (e.g. compression); empty: none.
using VideoLink = std::function<cv::Mat(const cv::Mat& grey)>;

/// Scene, renderer and link, shared by all trials of one configuration.
struct HoverWorld {
  PatchScene scene;
  PatchRenderer renderer;
  VideoLink link;
};
[[nodiscard]] HoverWorld make_hover_world(const HoverConfig& config, VideoLink link = {});

}  // namespace stillkite
