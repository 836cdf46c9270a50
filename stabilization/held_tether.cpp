#include "stabilization/held_tether.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

constexpr double kFarthestBlown_rad = 60 * kDegree;
constexpr double kBlownAside_m = 0.5;
constexpr double kZenith_rad = 90 * kDegree;

double between_rad(TetherState a, TetherState b) {
  a.length_m = b.length_m = 1;
  return angle_between_rad(position_in_station(a), position_in_station(b));
}

// Overhead a reading's azimuth is that of the wind.
TetherState kept_at_first(const TetherState& read) {
  const double aside_m = position_in_station(read).head<2>().norm();
  return aside_m < kBlownAside_m ? TetherState{read.length_m, kZenith_rad, 0} : read;
}

}  // namespace

void HeldTether::advance(Timestamp now) {
  const double dt_s = last_ ? seconds_between(*last_, now) : 0;
  if (last_ && !(dt_s > 0)) return;
  last_ = now;
  if (!held_) return;
  // closed form of r' = (u - r) / lag and of its integral
  const double gone = lag_s_ > 0 ? -std::expm1(-dt_s / lag_s_) : 1;
  const auto follow = [&](double command, double& rate, double& value) {
    value += command * dt_s + (rate - command) * (lag_s_ * gone);
    rate += (command - rate) * gone;
  };
  follow(command_.elevation_rate_rad_s, rate_.elevation_rate_rad_s, held_->elevation_rad);
  follow(command_.azimuth_rate_rad_s, rate_.azimuth_rate_rad_s, held_->azimuth_rad);
}

TetherState HeldTether::take(const TetherState& read) {
  if (!held_) held_ = kept_at_first(read);
  if (between_rad(*held_, read) > kFarthestBlown_rad) held_ = read;
  held_->length_m = read.length_m;
  return *held_;
}

}  // namespace stillkite
