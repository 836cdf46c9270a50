#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calibration/board_config.hpp"
#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Printed board, CV_8UC1, black and white. `side_px`: side of a square, or of a tag.
[[nodiscard]] cv::Mat board_image(const BoardConfig& board, int side_px);

/// Images of a board held in front of a camera.
struct BoardScene {
  BoardConfig board;
  Camera camera;
  int views = 60;
  double max_tilt_deg = 45;
  double blur_px = 0.7;  ///< standard deviation of the Gaussian
  double noise_grey = 2;
  bool in_upper_left_half = false;  ///< the board never reaches the lower right corner
};

/// Rendered images at random places, distances and tilts. Of a checkerboard all corners are in the
/// image.
[[nodiscard]] std::vector<cv::Mat> render_board_views(const BoardScene& scene, std::uint64_t seed);

}  // namespace stillkite
