#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

struct RotationGateConfig {
  double max_change_deg = 5;
  int max_consecutive_rejections = 3;

  static void fields(auto& self, auto&& field) {
    field("max_change_deg", self.max_change_deg, Range{0.01, 180},
          "maximum rotation from the last accepted frame");
    field("max_consecutive_rejections", self.max_consecutive_rejections, Range{0, 1000},
          "maximum number of consecutive rejections; the next frame is accepted");
  }
};

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
