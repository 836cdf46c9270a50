#pragma once

#include <vector>

#include "flow/flow_field.hpp"
#include "flow/flow_window.hpp"

namespace stillkite {

/// Takes every n-th vector of a dense field, in rows and columns, as a window. Its information is
/// that of the field, the same along both axes (the smaller eigenvalue bounds it from below), or
/// one where the method has none.
class FlowWindowSampler {
 public:
  /// Vectors about `stride_px` apart (>= 1); a sparser field is taken whole.
  explicit FlowWindowSampler(int stride_px) : stride_px_(stride_px) {}

  /// Good until the next call.
  const std::vector<FlowWindow>& operator()(const FlowField& field);

 private:
  int stride_px_;
  std::vector<FlowWindow> windows_;
};

}  // namespace stillkite
