#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <opencv2/video/tracking.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "flow/flow_field.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

enum class OpenCvFlowMethod {
  farneback,
  dis_ultrafast,
  dis_fast,
  dis_medium,
  pyramidal_lucas_kanade
};

template <>
struct EnumNames<OpenCvFlowMethod> {
  static constexpr auto value = std::to_array<std::pair<OpenCvFlowMethod, std::string_view>>(
      {{OpenCvFlowMethod::farneback, "farneback"},
       {OpenCvFlowMethod::dis_ultrafast, "dis_ultrafast"},
       {OpenCvFlowMethod::dis_fast, "dis_fast"},
       {OpenCvFlowMethod::dis_medium, "dis_medium"},
       {OpenCvFlowMethod::pyramidal_lucas_kanade, "pyramidal_lucas_kanade"}});
};

struct OpenCvFlowConfig {
  OpenCvFlowMethod method = OpenCvFlowMethod::farneback;
  int window_px = 15;
  int levels = 5;
  int stride_px = 8;

  static void fields(auto& self, auto&& field) {
    field("method", self.method, "which of OpenCV's flows");
    field("window_px", self.window_px, Range{3, 63}, "side of the window (not DIS)");
    field("levels", self.levels, Range{1, 10}, "of the pyramid (not DIS)");
    field("stride_px", self.stride_px, Range{1, 64},
          "distance of neighbouring vectors (pyramidal_lucas_kanade)");
  }
};

/// OpenCV's optical flows, for comparison: Farneback (2003), dense inverse search (Kroeger et al.
/// 2016) with its three presets, both one vector a pixel, and pyramidal Lucas-Kanade (Bouguet) on a
/// grid of `stride_px`. Of these only the last tells what it knows; a lost point has information 0.
class OpenCvFlow {
 public:
  /// Throws InputError when a value is out of range.
  explicit OpenCvFlow(const OpenCvFlowConfig& config);

  /// Frames are CV_8UC1 of one size, else InputError.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current);

 private:
  void track_grid(const cv::Mat& previous, const cv::Mat& current);

  OpenCvFlowConfig config_;
  cv::Ptr<cv::DenseOpticalFlow> dense_;  // null: the grid
  std::vector<cv::Point2f> from_px_, to_px_;
  std::vector<unsigned char> found_;
  std::vector<float> eigenvalues_;
  FlowField field_;
};

}  // namespace stillkite
