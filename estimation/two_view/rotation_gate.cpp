#include "estimation/two_view/rotation_gate.hpp"

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

bool RotationGate::accepts(const Eigen::Quaterniond& rotation) {
  const bool is_outlier =
      accepted_ && angle_between_rad(*accepted_, rotation) > config_.max_change_deg * kDegree;
  if (is_outlier && rejected_ < config_.max_consecutive_rejections) {
    ++rejected_;
    return false;
  }
  accepted_ = rotation;
  rejected_ = 0;
  return true;
}

void RotationGate::reset() {
  accepted_.reset();
  rejected_ = 0;
}

}  // namespace stillkite
