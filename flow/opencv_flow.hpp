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
    field("method", self.method, "OpenCV flow algorithm");
    field("window_px", self.window_px, Range{3, 63}, "side of the integration window (not DIS)");
    field("levels", self.levels, Range{1, 10}, "number of pyramid levels (not DIS)");
    field("stride_px", self.stride_px, Range{1, 64},
          "grid spacing of the vectors (pyramidal_lucas_kanade)");
  }
};

/// OpenCV's optical flows, for comparison. Dense: Farneback (2003) and dense inverse search
/// (Kroeger et al. 2016, three presets). On a grid of `stride_px`: pyramidal Lucas-Kanade
/// (Bouguet), the only one with information; a lost point has information 0.
class OpenCvFlow {
 public:
  /// Throws InputError if a value is out of range.
  explicit OpenCvFlow(const OpenCvFlowConfig& config);

  /// Frames: CV_8UC1, same size, else InputError. Valid until the next call.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current);

 private:
  void track_grid(const cv::Mat& previous, const cv::Mat& current);

  OpenCvFlowConfig config_;
  cv::Ptr<cv::DenseOpticalFlow> dense_;  // null: pyramidal Lucas-Kanade
  std::vector<cv::Point2f> from_px_, to_px_;
  std::vector<unsigned char> found_;
  std::vector<float> eigenvalues_;
  FlowField field_;
};

}  // namespace stillkite
