#include "navigation/best_navigator.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/fusion/error_state.hpp"
#include "estimation/two_view/ground_relief.hpp"
#include "navigation/motion_from_pose.hpp"
#include "navigation/motion_from_start.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

// Systematic errors of a feature's place: interpolation, the lens.
constexpr double kFeatureSigma_px = 0.3;

Matrix6d both_turned(const Matrix6d& covariance, const Eigen::Quaterniond& rotation) {
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = rotation.toRotationMatrix();
  return R * covariance * R.transpose();
}

// What may be wrong by as much as it is, in lengths and, taken for a turn, in lengths over the
// height.
Matrix6d unproven(double length, double height) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(length), Eigen::Vector3d::Constant(length / height);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

BestNavigator::BestNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                             const NavigatorConfig& config, const InitialState& initial, Mode mode)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      flow_(mode == Mode::paper
                ? FlowNavigator(PaperNavigator(camera, body_from_camera, config, initial))
                : FlowNavigator(KeyframeNavigator(camera, body_from_camera, config, initial))),
      reference_(camera, body_from_camera, config, initial, mode),
      choice_(config.choice),
      up_variance_(square(config.initial_tilt_sigma_rad)) {}

NavigationEstimate BestNavigator::step(const Frame& frame, const FrameInterval& interval,
                                       const SensorReadings& readings) {
  // 1. Either estimator by itself.
  const NavigationEstimate flow =
      std::visit([&](auto& method) { return method.step(frame, interval, readings); }, flow_);
  const NavigationEstimate reference = reference_.step(frame, interval, readings);
  if (reference.reference->relocalized) start_from_reference_ = start_from_home_;
  // 2. Which of them is to be believed, and where the camera is by it.
  take_unit(flow);
  decision_ = choice_.step(pair_of(flow, reference));
  // 3. A new reference is where the answer has the camera.
  if (reference.reference->new_reference) {
    if (reference.reference->on_first_reference) start_from_home_ = start_from_reference_;
    start_from_reference_ = decision_.start_from_camera;
  }
  NavigationEstimate out = answer(flow, reference);
  take_up(flow, out.world_from_body.rotation);
  out.upright = upright(out.pose_covariance);
  return out;
}

// A first height that comes late stretches the flow's world, and with it every length here.
void BestNavigator::take_unit(const NavigationEstimate& flow) {
  const RigidTransform world_from_start = flow.world_from_start * body_from_camera_;
  if (world_from_start_) {
    const double factor = world_from_start.translation.z() / world_from_start_->translation.z();
    if (factor == 1) return;
    choice_.stretch(factor);
    start_from_reference_.translation *= factor;
    start_from_home_.translation *= factor;
  }
  world_from_start_ = world_from_start;
}

// The answer's attitude goes back to the start's as that was told, the flow's own is levelled by
// the ground. Its errors last: it is taken again only where it knows twice as well.
void BestNavigator::take_up(const NavigationEstimate& flow,
                            const Eigen::Quaterniond& world_from_body) {
  constexpr double kBetter_ratio = 0.5;
  if (flow.verdict != Verdict::ok || decision_.source != EstimateSource::flow) return;
  const double variance = flow.pose_covariance.diagonal().segment<2>(3).maxCoeff();
  if (decision_.unproven_way > 0 || variance > kBetter_ratio * up_variance_) return;
  up_in_world_ =
      world_from_body * (flow.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  up_variance_ = variance;
}

GravityAlignment BestNavigator::upright(const Matrix6d& pose_covariance) const {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(up_in_world_, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d& start = world_from_start_->translation;
  return {.aligned_from_world = {turn, start - turn * start},
          .pose_covariance = both_turned(pose_covariance, turn),
          .sigma_rad = std::sqrt(up_variance_)};
}

EstimatePair BestNavigator::pair_of(const NavigationEstimate& flow,
                                    const NavigationEstimate& reference) const {
  const ReferenceReport& report = *reference.reference;
  EstimatePair pair{.flow = motion_from_start(flow, *world_from_start_, body_from_camera_),
                    .reference = report.motion,
                    .start_from_reference = start_from_reference_,
                    .relief_ratio = {},
                    .misfit_ratio = {},
                    .start_height = world_from_start_->translation.z()};
  const RigidTransform world_from_reference = *world_from_start_ * start_from_reference_;
  const Eigen::Vector3d normal =
      -(world_from_reference.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  const double sigma = std::max(kFeatureSigma_px, report.residual_px) / camera_.focal_x_px;
  const std::vector<BearingPair>& pairs = reference_.bearings().pairs;
  const RigidTransform start_from_camera =
      decision_.home_from_flow *
      RigidTransform{pair.flow.reference_from_camera, pair.flow.displacement_in_reference};
  pair.relief_ratio =
      ground_relief(pairs, reference_.inliers(), pose_from_motion(report.motion), normal, sigma);
  pair.misfit_ratio = ground_misfit(pairs, start_from_camera.inverse() * start_from_reference_,
                                    normal, world_from_reference.translation.z(), sigma);
  return pair;
}

NavigationEstimate BestNavigator::answer(const NavigationEstimate& flow,
                                         const NavigationEstimate& reference) const {
  const bool is_flow = decision_.source == EstimateSource::flow;
  NavigationEstimate out = is_flow ? flow : reference;
  const RigidTransform world_from_camera = *world_from_start_ * decision_.start_from_camera;
  out.world_from_body = world_from_camera * body_from_camera_.inverse();
  out.world_from_start = flow.world_from_start;
  if (is_flow) {
    const Eigen::Quaterniond& turn = decision_.home_from_flow.rotation;
    const Eigen::Quaterniond& world = world_from_start_->rotation;
    out.velocity_in_world_m_s = world_from_camera.rotation * flow.twist_in_camera.velocity_m_s;
    out.pose_covariance = both_turned(flow.pose_covariance, world * turn * world.conjugate()) +
                          both_turned(decision_.correction_covariance, world);
    if (decision_.unproven_way > 0) {
      const double height = world_from_start_->translation.z();
      out.pose_covariance += unproven(decision_.unproven_way, height);
      out.twist_covariance += unproven(flow.twist_in_camera.velocity_m_s.norm(), height);
    }
  }
  out.image_speed_px_s = flow.image_speed_px_s;
  out.image_shift_px = flow.image_shift_px;
  out.reference = reference.reference;
  out.stage_ms = sum_of_stages(flow.stage_ms, reference.stage_ms);
  return out;
}

std::vector<WindowFlow> BestNavigator::windows() const {
  if (decision_.source == EstimateSource::reference) return reference_.windows();
  return std::visit([](const auto& method) { return method.windows(); }, flow_);
}

}  // namespace stillkite
