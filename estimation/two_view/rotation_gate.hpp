#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "estimation/two_view/rotation_gate_config.hpp"

namespace stillkite {

/// Outlier rejection of the hold paper, section III. Rejects a rotation that differs by more than
/// `max_change_deg` from the last accepted one, at most `max_consecutive_rejections` times; then
/// accepts it. The difference is the rotation angle, which does not wrap as Euler angles do.
class RotationGate {
 public:
  explicit RotationGate(const RotationGateConfig& config) : config_(config) {}

  [[nodiscard]] bool accepts(const Eigen::Quaterniond& rotation);
  /// Accepts any next rotation.
  void reset();

 private:
  RotationGateConfig config_;
  std::optional<Eigen::Quaterniond> accepted_;
  int rejected_ = 0;
};

}  // namespace stillkite
