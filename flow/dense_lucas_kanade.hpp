#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flow/dense_lucas_kanade_config.hpp"
#include "flow/flow_field.hpp"

namespace stillkite {

/// Dense pyramidal Lucas-Kanade optical flow, one vector per pixel: LK(I(t+1), I(t)) of the flow
/// paper (section 4, step 3).
///
/// On each pyramid level, coarse to fine, from a warp field w:
///
///     e(p) = I1(p + w(p)) - I0(p),  g(p) = grad I0(p)        p and p + w(p) inside the image
///     G(x) = sum g g' - (sum g)(sum g)' / n,   b(x) = sum g e - (sum g)(sum e) / n
///     u(x) = w(x) - (G + N lambda I)^-1 b(x)
///
/// with sums over the n valid pixels of the N in the window about x. The second terms compensate a
/// brightness offset per window. Between iterations the mean of u over the window becomes w.
/// Without this the error grows where the window's frequency response is negative
/// (docs/plane_odometry.md).
class DenseLucasKanade {
 public:
  /// Throws InputError if a value is out of range.
  explicit DenseLucasKanade(const DenseLucasKanadeConfig& config);

  /// Frames: CV_8UC1, same size, else InputError. Initial flow: zero. The result is valid until the
  /// next call.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current);

  /// Initial flow from a homography of pixels, x' ~ H x, previous to current frame.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current,
                              const Eigen::Matrix3d& current_from_previous_px);

  /// Initial flow in pixels, CV_32FC2 of the frames' size; non-finite entries count as zero.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current,
                              const cv::Mat& predicted_flow_px);

 private:
  struct Level {
    cv::Size size;
    cv::Mat previous, current;  // padded: kRowMargin columns, images one row as well
    cv::Mat warp, flow;
  };

  void build_pyramids(const cv::Mat& previous, const cv::Mat& current);
  void allocate(cv::Size size);
  const FlowField& descend();
  void step(std::size_t level, bool with_information);

  DenseLucasKanadeConfig config_;
  std::vector<Level> levels_;
  std::vector<cv::Mat> scratch_;  // one per worker
  cv::Mat information_;
  FlowField field_;
};

}  // namespace stillkite
