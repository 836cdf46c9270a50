#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace stillkite::bench {

/// Two frames and the true flow from the first to the second, on the pixel grid of the first.
struct FlowPair {
  std::string name;
  cv::Mat previous;  ///< CV_8UC1
  cv::Mat current;
  cv::Mat truth_px;  ///< CV_32FC2; NaN: unknown or out of the image
};

/// Scenes A and B over a procedural ground and over each photograph
/// (simulation/flight/bench_scene.hpp). InputError for a file that is not an image.
[[nodiscard]] std::vector<FlowPair> rendered_pairs(
    const std::vector<std::filesystem::path>& photographs, double noise_grey, std::uint64_t seed);

/// Pairs of the Middlebury benchmark (Baker et al. 2011): one subfolder per pair with frame10.png,
/// frame11.png and flow10.flo. InputError for a file that cannot be read.
[[nodiscard]] std::vector<FlowPair> middlebury_pairs(const std::filesystem::path& folder);

}  // namespace stillkite::bench
