#pragma once

#include <variant>

#include "flow/dense_lucas_kanade.hpp"
#include "flow/opencv_flow.hpp"
#include "navigation/paper_config.hpp"

namespace stillkite {

/// The configured one of the dense flows.
class DenseFlow {
 public:
  /// Throws InputError when a value is out of range.
  explicit DenseFlow(const DenseFlowConfig& config);

  /// Good until the next call.
  const FlowField& operator()(const cv::Mat& previous, const cv::Mat& current) {
    return std::visit([&](auto& flow) -> const FlowField& { return flow(previous, current); },
                      flow_);
  }

 private:
  std::variant<DenseLucasKanade, OpenCvFlow> flow_;
};

}  // namespace stillkite
