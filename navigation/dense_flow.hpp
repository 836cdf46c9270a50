#pragma once

#include <variant>

#include "flow/dense_lucas_kanade.hpp"
#include "flow/opencv_flow.hpp"
#include "navigation/paper_config.hpp"

namespace stillkite {

/// Dense optical flow by the configured method.
class DenseFlow {
 public:
  /// Throws InputError if a value is out of range.
  explicit DenseFlow(const DenseFlowConfig& config);

  /// Flow from `previous` to `current` (CV_8UC1); valid until the next call.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current) {
    return std::visit([&](auto& flow) -> const FlowField& { return flow(previous, current); },
                      flow_);
  }

 private:
  std::variant<DenseLucasKanade, OpenCvFlow> flow_;
};

}  // namespace stillkite
