#pragma once

#include <array>
#include <span>
#include <vector>

#include "estimation/ego_motion/twist_equations.hpp"
#include "flow/flow_vector.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"

namespace stillkite {

/// Image cells; the jackknife assumes independent errors between cells.
inline constexpr int kCellColumns = 6;
inline constexpr int kCellRows = 5;
inline constexpr int kCells = kCellColumns * kCellRows;

/// Optical flow of one frame pair in normalised coordinates, one row per flow vector, sorted by
/// cell. Each cell is padded with zero-information rows to a multiple of `kPadding` (SIMD).
struct FlowRows {
  static constexpr std::size_t kPadding = 8;

  std::vector<double> x, y;            ///< bearing
  std::vector<double> inverse_depth;   ///< 1/m; 0 at and above the horizon
  std::vector<double> flow_x, flow_y;  ///< d(x, y)/dt, 1/s
  std::vector<double> gxx, gxy,
      gyy;  ///< information of the flow: dt^2 J^T G J, J = d(pixel)/d(x, y)
  std::vector<double> max_information;  ///< larger eigenvalue of G; 0: no information
  std::array<std::size_t, kCells + 1> cell_begin{};

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t size);
  void clear_row(std::size_t row);
};

/// Converts flow vectors into rows. Bearings and cells are cached while the pixels stay the same (a
/// grid).
class FlowRowMaker {
 public:
  explicit FlowRowMaker(const Camera& camera) : camera_(camera) {}

  /// Rows of `vectors`, measured over `dt_s`; `ground` in the previous camera frame. Without
  /// `use_information` every vector with nonzero information gets unit information (1/px^2). Valid
  /// until the next call.
  const FlowRows& make(std::span<const FlowVector> vectors, const GroundPlane& ground, double dt_s,
                       bool use_information);

 private:
  struct Ray {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
    bool valid = false;
    Eigen::Vector2d bearing = Eigen::Vector2d::Zero();
    Eigen::Matrix2d pixel_by_bearing = Eigen::Matrix2d::Zero();
    Eigen::Matrix2d bearing_by_pixel = Eigen::Matrix2d::Zero();
    std::size_t row = 0;
  };
  [[nodiscard]] bool is_cached(std::span<const FlowVector> vectors) const;
  void cache_rays(std::span<const FlowVector> vectors);

  Camera camera_;
  std::vector<Ray> rays_;
  FlowRows rows_;
};

/// Sums over the rows [begin, end): N = sum w M^T G M, b = sum w M^T G flow, M the motion field.
[[nodiscard]] TwistEquations weighted_sums(const FlowRows& rows, std::size_t begin, std::size_t end,
                                           std::span<const double> weights);

/// Squared Mahalanobis distance r^T G r of every row, r = flow - M twist.
void compute_squared_distances(const FlowRows& rows, const Vector6d& twist,
                               std::span<double> squared_distances);

}  // namespace stillkite
