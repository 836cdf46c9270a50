#include "stabilization/hold_config.hpp"

namespace stillkite {

HoldConfig in_shadow_mode(const HoldConfig& config) {
  HoldConfig shadow = config;
  shadow.recommended.predict = false;
  for (PidConfig* axis :
       {&shadow.paper.length, &shadow.paper.elevation, &shadow.paper.azimuth, &shadow.paper.yaw,
        &shadow.recommended.position, &shadow.recommended.yaw}) {
    axis->integral = 0;
  }
  return shadow;
}

}  // namespace stillkite
