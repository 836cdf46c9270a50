#include "estimation/sliding_window/window.hpp"

#include <algorithm>
#include <utility>

namespace stillkite {

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
  int at = ExtrinsicsIndex::kSize;
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

}  // namespace stillkite
