#include "estimation/sliding_window/window_step.hpp"

#include <algorithm>

namespace stillkite {
namespace {

// A step that would move a point behind the camera or onto it is far outside the linear range.
constexpr double kMaxDepthRatio_per_step = 5;

// Part of a step that is a similarity of the world about the first frame. Images do not show it: it
// is large until the IMU does. Applied additively, it would change what images show by its square.
struct StepSimilarity {
  double scale = 1;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  // `change` in place of x: x + change to first order
  [[nodiscard]] Eigen::Vector3d moved(const Eigen::Vector3d& x,
                                      const Eigen::Vector3d& change) const {
    const Eigen::Vector3d rest = change - (scale - 1) * x - rotation.cross(x);
    return scale * (so3_exp(rotation) * (x + rest));
  }
};

StepSimilarity similarity_of(const Eigen::VectorXd& step, const std::vector<int>& offsets,
                             const Window& window) {
  const RigidTransform& first = window.frames.front().state.world_from_imu;
  StepSimilarity out;
  out.origin_m = first.translation;
  out.rotation =
      first.rotation * step.segment<3>(offsets.front() + InertialIndex::kRotation).eval();
  const Eigen::VectorXd direction = scale_direction(window);
  const double squared = direction.squaredNorm();
  if (!(squared > 0)) return out;
  const double scale = 1 + direction.dot(step) / squared;
  // a larger step is no small change of a similarity
  if (scale > 1 / kMaxDepthRatio_per_step && scale < kMaxDepthRatio_per_step) out.scale = scale;
  return out;
}

void move_points(const Eigen::VectorXd& step, double scale, const WindowLinearization& linear,
                 Window& window) {
  for (const HostEquations& host : linear.hosts) {
    const std::vector<PairError> errors = pair_errors(host, linear.offsets, step);
    for (const PointEquations& point : host.points) {
      Eigen::Vector3d right = point.g;
      for (std::size_t i = 0; i < point.views; ++i) {
        const PointView& view = host.views[point.first_view + i];
        right -= view.W * errors[view.pair];
      }
      const Eigen::Vector3d d = point.inverse * right;
      InverseDepthPoint& target = *window.tracks[point.track].point;
      target.bearing += d.head<2>();
      const double unscaled = scale * target.inverse_depth + d.z();
      target.inverse_depth =
          std::clamp(unscaled, scale * target.inverse_depth / kMaxDepthRatio_per_step,
                     scale * target.inverse_depth * kMaxDepthRatio_per_step) /
          scale;
    }
  }
}

}  // namespace

Eigen::VectorXd scale_direction(const Window& window) {
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(offsets.back());
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    direction.segment<3>(offsets[i] + InertialIndex::kPosition) =
        window.frames[i].state.world_from_imu.translation -
        window.frames.front().state.world_from_imu.translation;
  }
  return direction;
}

void apply_step(const Eigen::VectorXd& step, const WindowLinearization& linear, Window& window) {
  const StepSimilarity similarity = similarity_of(step, linear.offsets, window);
  move_points(step, similarity.scale, linear, window);
  window.extrinsics = plus(window.extrinsics, step.head<ExtrinsicsIndex::kSize>());
  window.ground =
      plus(window.ground, step.segment<GroundIndex::kSize>(SharedIndex::kGround).eval());
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    InertialError error = InertialError::Zero();
    error.head(frame.size()) = step.segment(linear.offsets[i], frame.size());
    const InertialState before = frame.state;
    frame.state = plus(before, error);
    frame.state.world_from_imu.translation =
        similarity.origin_m +
        similarity.moved(before.world_from_imu.translation - similarity.origin_m,
                         error.segment<3>(InertialIndex::kPosition));
    frame.state.velocity_in_world_m_s =
        similarity.moved(before.velocity_in_world_m_s, error.segment<3>(InertialIndex::kVelocity));
  }
}

}  // namespace stillkite
