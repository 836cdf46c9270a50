#pragma once

#include <vector>

#include "geometry/rigid_transform.hpp"

namespace stillkite::python {

/// Poses world_from_body, stamps ascending.
struct PoseSeries {
  std::vector<StampedPose> poses;
  bool has_attitude = true;  ///< false: only the positions are known
};

}  // namespace stillkite::python
