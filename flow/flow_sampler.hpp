#pragma once

#include <vector>

#include "flow/flow_field.hpp"
#include "flow/flow_vector.hpp"

namespace stillkite {

/// Subsamples a flow field on a regular grid. Information matrix: the field's smaller eigenvalue
/// times identity, a lower bound; identity if the field has no information.
class FlowSampler {
 public:
  /// `stride_px` >= 1: spacing of the samples. A field with a larger stride is returned complete.
  explicit FlowSampler(int stride_px) : stride_px_(stride_px) {}

  /// Valid until the next call.
  const std::vector<FlowVector>& operator()(const FlowField& field);

 private:
  int stride_px_;
  std::vector<FlowVector> vectors_;
};

}  // namespace stillkite
