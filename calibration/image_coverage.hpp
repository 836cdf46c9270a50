#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "calibration/board_view.hpp"

namespace stillkite {

inline constexpr std::array<std::string_view, 4> kImageCorners{"upper left", "upper right",
                                                               "lower left", "lower right"};

/// Side of the regions at the image's corners in which the board must be seen, as a ratio of width
/// and height: a checkerboard's inner corners cannot be closer than one square to the border.
inline constexpr double kCornerRegion_ratio = 1.0 / 6;

/// Names of the image corners without a corner of the board.
[[nodiscard]] std::vector<std::string_view> unseen_corners(std::span<const BoardView> views,
                                                           int width_px, int height_px);

}  // namespace stillkite
