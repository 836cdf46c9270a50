#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flow/flow_field.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

struct DenseLucasKanadeConfig {
  int window_px = 21;
  int levels = 5;
  int steps = 2;
  int finest_steps = 1;
  double regularisation = 2.0;

  static void fields(auto& self, auto&& field) {
    field("window_px", self.window_px, Range{3, 63}, "side of the square window, odd");
    field("levels", self.levels, Range{1, 10}, "of the pyramid at most, each half the one below");
    field("steps", self.steps, Range{1, 20}, "Gauss-Newton steps on each coarser level");
    field("finest_steps", self.finest_steps, Range{1, 20}, "Gauss-Newton steps at full size");
    field("regularisation", self.regularisation, kPositive,
          "added to the mean structure tensor at full size, (grey/px)^2, a quarter each level up");
  }
};

/// Dense optical flow after Lucas and Kanade, one vector a pixel, as the flow paper uses it:
/// LK(I(t+1), I(t)), section 4, step 3.
///
/// On each level of a pyramid, from the coarsest to full size, and from a warp field w:
///
///     e(p) = I1(p + w(p)) - I0(p),  g(p) = grad I0(p)        where p and p + w(p) are in the image
///     G(x) = sum g g' - (sum g)(sum g)' / n,   b(x) = sum g e - (sum g)(sum e) / n
///     u(x) = w(x) - (G + N lambda I)^-1 b(x)     sums over those n pixels of the window's N round
///     x
///
/// The second terms let the brightness of each window change by an offset. Between steps u is
/// averaged over the window to give the next w: e(p) tells of the motion that p itself was warped
/// by, so without this the error of u grows wherever the window's frequency response is negative
/// (docs/flow_dense.md).
class DenseLucasKanade {
 public:
  /// Throws InputError when a value is out of range.
  explicit DenseLucasKanade(const DenseLucasKanadeConfig& config);

  /// Frames are CV_8UC1 of one size, else InputError. The first guess is no motion.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current);

  /// The first guess is x' ~ H x, pixels of the current frame from the previous one's.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current,
                              const Eigen::Matrix3d& current_from_previous_px);

  /// The first guess is a flow in pixels, CV_32FC2 of the frames' size; not finite means none.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current,
                              const cv::Mat& predicted_flow_px);

 private:
  struct Level {
    cv::Size size;
    cv::Mat previous, current;  // kRowMargin wider than the size, and the images a row higher
    cv::Mat warp, flow;
  };

  void build_pyramids(const cv::Mat& previous, const cv::Mat& current);
  void allocate(cv::Size size);
  const FlowField& descend();
  void step(std::size_t level, bool with_information);

  DenseLucasKanadeConfig config_;
  std::vector<Level> levels_;
  std::vector<cv::Mat> scratch_;  // one a worker
  cv::Mat information_;
  FlowField field_;
};

}  // namespace stillkite
