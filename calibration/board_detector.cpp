#include "calibration/board_detector.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace stillkite {
namespace {

using Quad = std::vector<cv::Point2f>;

// Kalibr's tags have a black border of two cells, those of other printers one.
constexpr int kKalibrBorder_cells = 2;

void add_corner(BoardView& view, int id, const Eigen::Vector2d& corner_m,
                const cv::Point2f& pixel) {
  view.ids.push_back(id);
  view.corners_m.push_back(corner_m);
  view.pixels.emplace_back(pixel.x, pixel.y);
}

BoardView checkerboard_view(const cv::Mat& grey, const BoardConfig& board) {
  const cv::Size inner(board.columns - 1, board.rows - 1);
  BoardView view;
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(grey, inner, corners, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return view;
  }
  for (int id = 0; id < inner.area(); ++id) {
    add_corner(view, id, board.square_m * Eigen::Vector2d(id % inner.width, id / inner.width),
               corners[id]);
  }
  return view;
}

// Position of a tag's corner; the tags count from the lower left, along the rows (Kalibr). Corners
// in OpenCV's order: upper left, upper right, lower right, lower left.
Eigen::Vector2d aprilgrid_corner_m(const BoardConfig& board, int tag, int corner) {
  const double pitch_m = board.square_m * (1 + board.tag_spacing_ratio);
  const Eigen::Vector2d lower_left_m =
      pitch_m * Eigen::Vector2d(tag % board.columns, tag / board.columns);
  const bool right = corner == 1 || corner == 2;
  const bool upper = corner < 2;
  return lower_left_m + board.square_m * Eigen::Vector2d(right, upper);
}

double mean_side_px(const Quad& quad) {
  double sum_px = 0;
  for (int i = 0; i < 4; ++i) sum_px += cv::norm(quad[i] - quad[(i + 1) % 4]);
  return sum_px / 4;
}

// Median distance of the corners from the homography of the whole grid.
double median_grid_error_px(const BoardView& view) {
  std::vector<cv::Point2d> from, to;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    from.emplace_back(view.corners_m[i].x(), view.corners_m[i].y());
    to.emplace_back(view.pixels[i].x(), view.pixels[i].y());
  }
  const cv::Mat H = cv::findHomography(from, to, cv::LMEDS);
  if (H.empty()) return HUGE_VAL;
  std::vector<cv::Point2d> mapped;
  cv::perspectiveTransform(from, mapped, H);
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < to.size(); ++i) errors_px.push_back(cv::norm(mapped[i] - to[i]));
  const auto middle = errors_px.begin() + static_cast<std::ptrdiff_t>(errors_px.size() / 2);
  std::nth_element(errors_px.begin(), middle, errors_px.end());
  return *middle;
}

// The corner at which a tag's code begins differs between printers: the grid itself decides.
BoardView aprilgrid_view(const std::vector<Quad>& quads, const std::vector<int>& tags,
                         const BoardConfig& board) {
  constexpr double kMaxError_ratio = 0.15;  // lens distortion over the grid; wrong corners: > 0.5
  BoardView best;
  if (quads.size() < 2) return best;
  double side_px = 0;
  for (const Quad& quad : quads) side_px += mean_side_px(quad) / static_cast<double>(quads.size());
  double best_px = kMaxError_ratio * side_px;
  for (int first = 0; first < 4; ++first) {
    BoardView view;
    for (std::size_t i = 0; i < quads.size(); ++i) {
      for (int j = 0; j < 4; ++j) {
        const int corner = (j + first) % 4;
        add_corner(view, 4 * tags[i] + corner, aprilgrid_corner_m(board, tags[i], corner),
                   quads[i][j]);
      }
    }
    const double error_px = median_grid_error_px(view);
    if (error_px >= best_px) continue;
    best_px = error_px;
    best = std::move(view);
  }
  return best;
}

// Saddle points of the corners (cv::cornerSubPix). The window of a corner is a share of the
// distance to its nearest neighbour, so that no other edge is in it; in a larger one the lens bends
// the edges.
void refine_corners(const cv::Mat& grey, double window_ratio, BoardView& view) {
  constexpr int kMinWindow_px = 2, kMaxWindow_px = 6;
  constexpr int kMaxIterations = 40;
  constexpr double kMinStep_px = 1e-3;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    double nearest_px = HUGE_VAL;
    for (std::size_t j = 0; j < view.pixels.size(); ++j) {
      if (j != i) nearest_px = std::min(nearest_px, (view.pixels[i] - view.pixels[j]).norm());
    }
    const int window_px = std::clamp(static_cast<int>(window_ratio * std::min(nearest_px, 1e3)),
                                     kMinWindow_px, kMaxWindow_px);
    std::vector<cv::Point2f> corner{
        {static_cast<float>(view.pixels[i].x()), static_cast<float>(view.pixels[i].y())}};
    cv::cornerSubPix(
        grey, corner, {window_px, window_px}, {-1, -1},
        {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, kMaxIterations, kMinStep_px});
    view.pixels[i] = {corner[0].x, corner[0].y};
  }
}

// Share of the distance between two corners that has no edge but those of the corner.
double window_ratio(const BoardConfig& board) {
  constexpr double kCheckerboard = 0.3;
  constexpr double kKalibrBorder = 0.2;  // of the tag, of the spacing square less
  switch (board.type) {
    case BoardType::checkerboard:
      break;
    case BoardType::charuco:
      return 0.5 * (1 - board.marker_ratio);
    case BoardType::aprilgrid:
      return 0.7 * std::min(kKalibrBorder / board.tag_spacing_ratio, 1.0);
  }
  return kCheckerboard;
}

}  // namespace

struct BoardDetector::Markers {
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  cv::Ptr<cv::aruco::DetectorParameters> parameters;
  cv::Ptr<cv::aruco::CharucoBoard> charuco;  // null: aprilgrid

  [[nodiscard]] BoardView charuco_view(const cv::Mat& grey) const {
    BoardView view;
    std::vector<Quad> quads;
    std::vector<int> markers, ids;
    cv::aruco::detectMarkers(grey, dictionary, quads, markers, parameters);
    if (markers.empty()) return view;
    std::vector<cv::Point2f> corners;
    cv::aruco::interpolateCornersCharuco(quads, markers, grey, charuco, corners, ids);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const cv::Point3f& at = charuco->chessboardCorners[ids[i]];
      add_corner(view, ids[i], {at.x, at.y}, corners[i]);
    }
    return view;
  }

  [[nodiscard]] BoardView tags_view(const cv::Mat& grey, const BoardConfig& board) const {
    std::vector<Quad> quads, in_grid;
    std::vector<int> tags, ids;
    for (const int border_cells : {kKalibrBorder_cells, 1}) {
      parameters->markerBorderBits = border_cells;
      cv::aruco::detectMarkers(grey, dictionary, quads, tags, parameters);
      if (!tags.empty()) break;
    }
    for (std::size_t i = 0; i < tags.size(); ++i) {
      if (tags[i] >= board.columns * board.rows) continue;
      in_grid.push_back(quads[i]);
      ids.push_back(tags[i]);
    }
    return aprilgrid_view(in_grid, ids, board);
  }
};

BoardDetector::BoardDetector(const BoardConfig& board) : board_(board) {
  if (board.type == BoardType::checkerboard) {
    if (std::min(board.columns, board.rows) < 4) {
      throw InputError("calibration_board: a checkerboard needs at least 4 x 4 squares");
    }
    return;
  }
  markers_ = std::make_unique<Markers>();
  const bool is_grid = board.type == BoardType::aprilgrid;
  const auto dictionary = is_grid ? MarkerDictionary::april_36h11 : board.dictionary;
  markers_->dictionary = cv::aruco::getPredefinedDictionary(static_cast<int>(dictionary));
  markers_->parameters = cv::aruco::DetectorParameters::create();
  const int markers = is_grid ? board.columns * board.rows : board.columns * board.rows / 2;
  if (markers > markers_->dictionary->bytesList.rows) {
    throw InputError(fmt::format(
        "calibration_board: {} markers, but {} has {}; set the columns, rows and dictionary of the "
        "board",
        markers, name_of(dictionary), markers_->dictionary->bytesList.rows));
  }
  if (!is_grid) {
    markers_->charuco = cv::aruco::CharucoBoard::create(
        board.columns, board.rows, static_cast<float>(board.square_m),
        static_cast<float>(board.marker_ratio * board.square_m), markers_->dictionary);
  }
}

BoardDetector::~BoardDetector() = default;
BoardDetector::BoardDetector(BoardDetector&&) noexcept = default;
BoardDetector& BoardDetector::operator=(BoardDetector&&) noexcept = default;

std::optional<BoardView> BoardDetector::detect(const cv::Mat& grey) const {
  BoardView view = !markers_           ? checkerboard_view(grey, board_)
                   : markers_->charuco ? markers_->charuco_view(grey)
                                       : markers_->tags_view(grey, board_);
  if (view.ids.size() < kMinBoardCorners) return std::nullopt;
  refine_corners(grey, window_ratio(board_), view);
  return view;
}

}  // namespace stillkite
