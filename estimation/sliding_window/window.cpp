#include "estimation/sliding_window/window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stillkite {
namespace {

// Beyond the range of the first-order correction of a second's motion.
bool biases_have_changed(const WindowFrame& frame) {
  constexpr double kMin_rad_s = 1e-3;
  constexpr double kMin_m_s2 = 1e-2;
  const InertialState& state = frame.state;
  return (state.gyro_bias_rad_s - frame.imu.gyro_bias_rad_s()).norm() > kMin_rad_s ||
         (state.accel_bias_m_s2 - frame.imu.accel_bias_m_s2()).norm() > kMin_m_s2;
}

// Common factor of the distances from an origin, since the first estimates.
double change_of_scale(const Window& window, const Eigen::Vector3d& origin_m,
                       const Eigen::Vector3d& origin_to_m) {
  double along_m2 = 0;
  double squared_m2 = 0;
  for (const WindowFrame& frame : window.frames) {
    if (!frame.first_estimate) continue;
    const Eigen::Vector3d first_m = frame.first_estimate->world_from_imu.translation - origin_m;
    along_m2 += first_m.dot(frame.state.world_from_imu.translation - origin_to_m);
    squared_m2 += first_m.squaredNorm();
  }
  return along_m2 > 0 && squared_m2 > 0 ? along_m2 / squared_m2 : 1;
}

}  // namespace

Vector6d WindowFrame::pose_rate() const {
  Vector6d rate;
  rate << gyro_rad_s - state.gyro_bias_rad_s, state.velocity_in_world_m_s;
  return rate;
}

RigidTransform WindowFrame::world_from_imu_after(double shift_s, bool at_first_estimate) const {
  const RigidTransform& pose =
      at_first_estimate ? linearization().world_from_imu : state.world_from_imu;
  if (shift_s == 0) return pose;
  const Vector6d error = shift_s * pose_rate();
  return {(pose.rotation * so3_exp(error.head<3>())).normalized(),
          pose.translation + error.tail<3>()};
}

const WindowObservation* WindowTrack::in(std::int64_t frame_id) const {
  const auto at = std::find_if(observations.rbegin(), observations.rend(),
                               [&](const WindowObservation& o) { return o.frame_id == frame_id; });
  return at == observations.rend() ? nullptr : &*at;
}

std::vector<int> Window::offsets() const {
  std::vector<int> offsets;
  offsets.reserve(frames.size() + 1);
  int at = SharedIndex::kSize;
  for (const WindowFrame& frame : frames) {
    offsets.push_back(at);
    at += frame.size();
  }
  offsets.push_back(at);
  return offsets;
}

std::optional<std::size_t> Window::find(std::int64_t frame_id) const {
  const auto at = std::lower_bound(frames.begin(), frames.end(), frame_id,
                                   [](const WindowFrame& f, std::int64_t id) { return f.id < id; });
  if (at == frames.end() || at->id != frame_id) return std::nullopt;
  return static_cast<std::size_t>(at - frames.begin());
}

Timestamp Window::imu_time(Timestamp image) const {
  return {image.ns + from_seconds(first_extrinsics.time_offset_s).ns};
}

void append_frame(Window& window, WindowFrame frame) {
  window.frames.push_back(std::move(frame));
  const Eigen::Index size = window.offsets().back();
  MarginalPrior& prior = window.prior;
  const Eigen::Index before = prior.gradient.size();
  prior.information.conservativeResize(size, size);
  prior.gradient.conservativeResize(size);
  prior.information.rightCols(size - before).setZero();
  prior.information.bottomRows(size - before).setZero();
  prior.gradient.tail(size - before).setZero();
}

void integrate_imu(Window& window, std::size_t frame) {
  WindowFrame& at = window.frames[frame];
  const Timestamp from = window.imu_time(window.frames[frame - 1].stamp);
  const Timestamp to = window.imu_time(at.stamp);
  ImuPreintegration imu(at.imu.noise());
  imu.reintegrate(at.state.gyro_bias_rad_s, at.state.accel_bias_m_s2);
  for (const ImuSample& sample : window.imu.between(from, to)) imu.add(sample);
  at.imu = std::move(imu);
  at.gyro_rad_s = window.imu.at(to).angular_rate_rad_s;
}

void move_window(Window& window, const Eigen::Quaterniond& yaw, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  const RigidTransform world_from_before{yaw, to - yaw * from};
  const auto move = [&](InertialState& state) {
    RigidTransform& pose = state.world_from_imu;
    pose = world_from_before * pose;
    pose.rotation.normalize();
    state.velocity_in_world_m_s = yaw * state.velocity_in_world_m_s;
  };
  // errors of positions, velocities and ground are in world axes
  const std::vector<int> offsets = window.offsets();
  Eigen::MatrixXd axes = Eigen::MatrixXd::Identity(offsets.back(), offsets.back());
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    move(frame.state);
    if (frame.first_estimate) move(*frame.first_estimate);
    const int position = offsets[i] + InertialIndex::kPosition;
    axes.block<3, 3>(position, position) = yaw.toRotationMatrix();
    if (!frame.has_motion) continue;
    const int velocity = offsets[i] + InertialIndex::kVelocity;
    axes.block<3, 3>(velocity, velocity) = yaw.toRotationMatrix();
  }
  const Eigen::Matrix2d turn = yaw.toRotationMatrix().topLeftCorner<2, 2>();
  const Eigen::Vector2d shift_m = world_from_before.translation.head<2>();
  for (WindowGround* ground : {&window.ground, &window.first_ground}) {
    ground->slope = turn * ground->slope;
    ground->height_m += world_from_before.translation.z() - ground->slope.dot(shift_m);
  }
  axes.block<2, 3>(SharedIndex::kGround, SharedIndex::kGround) << turn, shift_m;
  window.prior.information = axes * window.prior.information * axes.transpose();
  window.prior.gradient = axes * window.prior.gradient;
}

void move_first_estimates(Window& window) {
  const auto newest = std::find_if(window.frames.rbegin(), window.frames.rend(),
                                   [](const WindowFrame& f) { return f.first_estimate; });
  if (newest == window.frames.rend()) return;
  const Eigen::Vector3d origin_m = newest->first_estimate->world_from_imu.translation;
  const Eigen::Vector3d origin_to_m = newest->state.world_from_imu.translation;
  const double factor = change_of_scale(window, origin_m, origin_to_m);
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd change = Eigen::VectorXd::Zero(offsets.back());
  const auto move = [&](int at, Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    change.segment<3>(at) = to - from;
    from = to;
  };
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    if (!frame.first_estimate) continue;
    Eigen::Vector3d& position_m = frame.first_estimate->world_from_imu.translation;
    Eigen::Vector3d& velocity_m_s = frame.first_estimate->velocity_in_world_m_s;
    move(offsets[i] + InertialIndex::kPosition, position_m,
         origin_to_m + factor * (position_m - origin_m));
    if (!frame.has_motion) continue;
    move(offsets[i] + InertialIndex::kVelocity, velocity_m_s, factor * velocity_m_s);
  }
  // to the present height below the newest frame; the slope stays
  const auto height_m = [&](const WindowGround& ground) {
    return ground.height_m + ground.slope.dot(origin_to_m.head<2>());
  };
  const double rise_m = height_m(window.ground) - height_m(window.first_ground);
  change[SharedIndex::kGround + GroundIndex::kHeight] = rise_m;
  window.first_ground.height_m += rise_m;
  window.prior.gradient -= window.prior.information * change;
}

void linearize_at_present(Window& window) {
  constexpr double kMinShift_s = 2e-5;
  const double shift_s = window.image_shift_s();
  const bool is_shifted = std::abs(shift_s) > kMinShift_s;
  const double unshifted_s = window.first_extrinsics.time_offset_s;
  if (is_shifted) {
    for (WindowFrame& frame : window.frames) {
      frame.state.world_from_imu = frame.world_from_imu_after(shift_s, false);
    }
  }
  window.first_extrinsics = window.extrinsics;
  window.first_ground = window.ground;
  if (!is_shifted) window.first_extrinsics.time_offset_s = unshifted_s;
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    if (is_shifted || biases_have_changed(window.frames[i])) integrate_imu(window, i);
  }
}

}  // namespace stillkite
