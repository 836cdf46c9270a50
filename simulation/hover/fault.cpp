#include "simulation/hover/fault.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angle.hpp"

namespace stillkite {

FaultEffect effect_of(const FaultConfig& fault, double t_s) {
  const double since_start_s = t_s - fault.start_s;
  const double remaining_s = fault.duration_s - since_start_s;
  FaultEffect effect;
  const double bias_rad_s = fault.gyro_bias_deg_s * kDegree;
  if (fault.kind == FaultKind::gyro_bias) {
    effect.heading_error_rad = bias_rad_s * std::clamp(since_start_s, 0.0, fault.duration_s);
  }
  if (since_start_s < 0 || remaining_s <= 0) return effect;
  switch (fault.kind) {
    case FaultKind::frozen_video:
      effect.is_video_frozen = true;
      break;
    case FaultKind::every_third_frame_lost:
      effect.is_every_third_frame_lost = true;
      break;
    case FaultKind::stamps_off:
      effect.stamp_offset_s = fault.stamp_offset_s;
      break;
    case FaultKind::picture_dark:
      effect.light_ratio = fault.light_ratio;
      break;
    case FaultKind::reference_blind:
      effect.covered_ratio = fault.covered_ratio;
      break;
    case FaultKind::flow_blind:
      effect.floor_displacement_m = fault.floor_swing_m *
                                    std::sin(std::numbers::pi * since_start_s) *
                                    Eigen::Vector3d(1, 1, 0).normalized();
      break;
    case FaultKind::height_step:
      effect.floor_displacement_m.z() = fault.floor_rise_m;
      break;
    case FaultKind::gyro_bias:
      effect.gyro_bias_rad_s = bias_rad_s;
      break;
    case FaultKind::tether_slack:
      effect.loose_tether_m = std::min(fault.loose_tether_m,
                                       fault.loosening_m_s * std::min(since_start_s, remaining_s));
      break;
  }
  return effect;
}

}  // namespace stillkite
