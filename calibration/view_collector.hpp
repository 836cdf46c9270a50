#pragma once

#include <optional>
#include <vector>

#include "calibration/board_view.hpp"

namespace stillkite {

/// Removes nearly equal views of a video: of the views within 2 % of the image width of each other
/// the one with the slowest motion, which has the least blur and shutter distortion, is kept.
class ViewCollector {
 public:
  explicit ViewCollector(int width_px) : width_px_(width_px) {}

  void add(BoardView view);

  /// Views kept so far, the last one included.
  [[nodiscard]] std::vector<BoardView> views() const;

 private:
  int width_px_;
  std::optional<BoardView> first_, previous_, slowest_;  // of the present group
  double slowest_px_s_ = 0;  // speed of the corners in `slowest_`; infinite if unknown
  std::vector<BoardView> kept_;
};

}  // namespace stillkite
