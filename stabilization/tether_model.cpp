#include "stabilization/tether_model.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

constexpr double kMaxWindDeflection_rad = 60 * kDegree;
constexpr double kTakeOffRadius_m = 0.5;
constexpr double kZenith_rad = 90 * kDegree;

double angle_between_tethers_rad(TetherState a, TetherState b) {
  a.length_m = b.length_m = 1;
  return angle_between_rad(position_in_station(a), position_in_station(b));
}

// Near the zenith the measured azimuth is the wind's direction.
TetherState initial_state(const TetherState& measured) {
  const double radius_m = position_in_station(measured).head<2>().norm();
  return radius_m < kTakeOffRadius_m ? TetherState{measured.length_m, kZenith_rad, 0} : measured;
}

}  // namespace

void TetherModel::advance(Timestamp now) {
  const double dt_s = last_ ? seconds_between(*last_, now) : 0;
  if (last_ && !(dt_s > 0)) return;
  last_ = now;
  if (!state_) return;
  // closed form of r' = (u - r) / lag and of its integral
  const double response = lag_s_ > 0 ? -std::expm1(-dt_s / lag_s_) : 1;
  const auto follow = [&](double command, double& rate, double& value) {
    value += command * dt_s + (rate - command) * (lag_s_ * response);
    rate += (command - rate) * response;
  };
  follow(command_.elevation_rate_rad_s, rate_.elevation_rate_rad_s, state_->elevation_rad);
  follow(command_.azimuth_rate_rad_s, rate_.azimuth_rate_rad_s, state_->azimuth_rad);
}

TetherState TetherModel::update(const TetherState& measured) {
  if (!state_) state_ = initial_state(measured);
  if (angle_between_tethers_rad(*state_, measured) > kMaxWindDeflection_rad) state_ = measured;
  state_->length_m = measured.length_m;
  return *state_;
}

}  // namespace stillkite
