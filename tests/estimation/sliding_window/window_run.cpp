#include "window_run.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

WindowRun::WindowRun(unsigned seed) : random(seed) {
  points = points_in_view(motion, 200, random);
  RigidTransform first = motion.state(0).world_from_imu;
  first.rotation = first.rotation * so3_exp({0.2, -0.3, 0});
  window.emplace(motion.extrinsics, first, kImu, InertialPriors{});
}

std::vector<FeatureObservation> WindowRun::features() {
  return observe(motion, kFrame_s * frame + time_offset_s, points, kBearingSigma, random);
}

void WindowRun::step() {
  advance(features());
}

void WindowRun::advance(const std::vector<FeatureObservation>& features,
                        const std::optional<KeyframeView>& ground) {
  const double t_s = kFrame_s * frame;
  const double until_s = t_s + std::max(0.0, time_offset_s);
  const auto readings = motion.readings(imu_s, until_s, kImu, random);
  imu_s = until_s;
  window->add_frame(from_seconds(t_s), readings, features, {}, ground);
  if (frame % 5 == 0 && !features.empty()) window->take_keyframe(features);
  ++frame;
}

RigidTransform WindowRun::truth_from_world() const {
  const WindowFrame& first = window->window().frames.front();
  const RigidTransform truth = motion.state(to_seconds(first.stamp)).world_from_imu;
  const RigidTransform& estimate = first.state.world_from_imu;
  const Eigen::Quaterniond rotation = truth.rotation * estimate.rotation.conjugate();
  const Eigen::Quaterniond yaw = so3_exp({0, 0, 2 * std::atan2(rotation.z(), rotation.w())});
  return {yaw, truth.translation - yaw * estimate.translation};
}

InertialState WindowRun::aligned_state(const RigidTransform& truth_from_world) const {
  InertialState state = window->state();
  state.world_from_imu = truth_from_world * state.world_from_imu;
  state.velocity_in_world_m_s = truth_from_world.rotation * state.velocity_in_world_m_s;
  return state;
}

}  // namespace stillkite
