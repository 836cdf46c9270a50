#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "calibration/board_config.hpp"
#include "calibration/board_view.hpp"

namespace stillkite {

/// Views with fewer corners do not determine a pose well.
inline constexpr std::size_t kMinBoardCorners = 8;

/// Finds the corners of a board to a fraction of a pixel.
class BoardDetector {
 public:
  /// Throws InputError if the board has more markers than its dictionary.
  explicit BoardDetector(const BoardConfig& board);
  ~BoardDetector();
  BoardDetector(BoardDetector&&) noexcept;
  BoardDetector& operator=(BoardDetector&&) noexcept;

  /// Corners in a grey image (CV_8UC1), without stamp and frame. Nullopt below kMinBoardCorners;
  /// of a checkerboard unless all of them are found.
  [[nodiscard]] std::optional<BoardView> detect(const cv::Mat& grey) const;

 private:
  struct Markers;
  BoardConfig board_;
  std::unique_ptr<Markers> markers_;  // null: checkerboard
};

}  // namespace stillkite
