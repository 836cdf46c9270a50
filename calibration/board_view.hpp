#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// Corners of the board in one image.
struct BoardView {
  Timestamp stamp;
  std::int64_t frame = 0;                  ///< index in the source
  std::vector<int> ids;                    ///< numbers of the corners on the board
  std::vector<Eigen::Vector2d> corners_m;  ///< on the board's plane
  std::vector<Eigen::Vector2d> pixels;
};

}  // namespace stillkite
