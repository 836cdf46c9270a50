#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "geometry/fields.hpp"

namespace stillkite {

struct RotationGateConfig {
  double max_change_deg = 5;
  int strikes = 3;

  static void fields(auto& self, auto&& field) {
    field("max_change_deg", self.max_change_deg, Range{0.01, 180},
          "from the last accepted rotation, beyond which a frame is an outlier");
    field("strikes", self.strikes, Range{0, 1000}, "outliers in a row before the next is accepted");
  }
};

/// The hold paper's outlier rejector (section III): a rotation that differs by more than the limit
/// from the last accepted one is rejected, three times in a row; the fourth is the new value. The
/// difference is the angle between the rotations: Euler angles wrap.
class RotationGate {
 public:
  explicit RotationGate(const RotationGateConfig& config) : config_(config) {}

  [[nodiscard]] bool accepts(const Eigen::Quaterniond& rotation);
  /// The next rotation is accepted whatever it is.
  void reset();

 private:
  RotationGateConfig config_;
  std::optional<Eigen::Quaterniond> accepted_;
  int rejected_ = 0;
};

}  // namespace stillkite
