#pragma once

#include <array>
#include <span>
#include <vector>

#include "estimation/ego_motion/twist_equations.hpp"
#include "flow/flow_window.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"

namespace stillkite {

/// Cells of the image, whose errors the jackknife takes as independent.
inline constexpr int kCellColumns = 6;
inline constexpr int kCellRows = 5;
inline constexpr int kCells = kCellColumns * kCellRows;

/// The flow of one frame pair in normalised coordinates, one row a window, cell after cell. Each
/// cell is padded with rows without information to a multiple of `kPadding`, so that vector code
/// needs no remainder loop.
struct FlowRows {
  static constexpr std::size_t kPadding = 8;

  std::vector<double> x, y;            ///< bearing
  std::vector<double> inverse_depth;   ///< 1/m; 0 at and above the horizon
  std::vector<double> flow_x, flow_y;  ///< d(x, y)/dt, 1/s
  std::vector<double> gxx, gxy, gyy;   ///< information of the flow, s^2/px^2 times the window's
  std::vector<double> best_known;      ///< larger eigenvalue of the window's; 0: no information
  std::array<std::size_t, kCells + 1> cell_begin{};

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size);
  void clear_row(std::size_t row);
};

/// Where windows look, and the rows they make. Windows that stay where they were, on a grid, are
/// undistorted and sorted into cells only once.
class FlowRowMaker {
 public:
  explicit FlowRowMaker(const Camera& camera) : camera_(camera) {}

  /// With `informed` false every window that carries any information carries the same (1/px^2).
  /// Good until the next call.
  const FlowRows& make(std::span<const FlowWindow> windows, const GroundPlane& ground, double dt_s,
                       bool informed);

 private:
  struct Ray {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
    bool imaged = false;
    Eigen::Vector2d bearing = Eigen::Vector2d::Zero();
    Eigen::Matrix2d pixel_by_bearing = Eigen::Matrix2d::Zero();
    Eigen::Matrix2d bearing_by_pixel = Eigen::Matrix2d::Zero();
    std::size_t row = 0;
  };
  [[nodiscard]] bool knows(std::span<const FlowWindow> windows) const;
  void look_up(std::span<const FlowWindow> windows);

  Camera camera_;
  std::vector<Ray> rays_;
  FlowRows rows_;
};

/// Sum over the rows [begin, end) of w M^T G M and w M^T G flow, M the motion field.
[[nodiscard]] TwistEquations weighted_sums(const FlowRows& rows, std::size_t begin, std::size_t end,
                                           std::span<const double> weights);

/// r^T G r of every row, r = flow - M twist.
void measure_squared_distances(const FlowRows& rows, const Vector6d& twist,
                               std::span<double> squared_distances);

}  // namespace stillkite
