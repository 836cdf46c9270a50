#include "flow/flow_sampler.hpp"

#include <algorithm>

namespace stillkite {

const std::vector<FlowVector>& FlowSampler::operator()(const FlowField& field) {
  const int step = std::max(1, stride_px_ / field.stride_px);
  const int first = step / 2;  // equal margins on both sides
  vectors_.clear();
  for (int row = first; row < field.flow_px.rows; row += step) {
    const auto* flow_px = field.flow_px.ptr<cv::Vec2f>(row);
    const auto* information =
        field.information.empty() ? nullptr : field.information.ptr<float>(row);
    for (int column = first; column < field.flow_px.cols; column += step) {
      const auto position_px = [&](int index) {
        const int position = index * field.stride_px + field.stride_px / 2;
        return static_cast<float>(position);
      };
      const float information_value = information != nullptr ? information[column] : 1.0F;
      vectors_.push_back({.pixel = {position_px(column), position_px(row)},
                          .flow_px = {flow_px[column][0], flow_px[column][1]},
                          .information_xx = information_value,
                          .information_yy = information_value});
    }
  }
  return vectors_;
}

}  // namespace stillkite
