#include "navigation/best_navigator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/fusion/error_state.hpp"
#include "estimation/two_view/ground_relief.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/motion_conversion.hpp"

namespace stillkite {
namespace {

// Systematic feature error: interpolation and lens.
constexpr double kFeatureSigma_px = 0.3;

Matrix6d rotate_covariance(const Matrix6d& covariance, const Eigen::Quaterniond& rotation) {
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = rotation.toRotationMatrix();
  return R * covariance * R.transpose();
}

// Diagonal covariance of an error as large as the length itself: `length` per translation axis and
// length / height per rotation axis, because translation and rotation are ambiguous.
Matrix6d scale_error_covariance(double length, double height) {
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
  // 1. Run both estimators.
  const NavigationEstimate flow =
      std::visit([&](auto& method) { return method.step(frame, interval, readings); }, flow_);
  const NavigationEstimate reference = reference_.step(frame, interval, readings);
  if (reference.reference->relocalized) initial_from_reference_ = initial_from_first_reference_;
  // 2. Select one, and compute the camera pose from it.
  update_scale(flow);
  decision_ = choice_.step(pair_of(flow, reference));
  // 3. Place a new reference at the selected pose.
  if (reference.reference->new_reference) {
    if (reference.reference->on_first_reference)
      initial_from_first_reference_ = initial_from_reference_;
    initial_from_reference_ = decision_.initial_from_camera;
  }
  NavigationEstimate out = answer(flow, reference);
  update_vertical(flow, out.world_from_body.rotation);
  out.gravity_alignment = gravity_alignment(out.pose_covariance);
  return out;
}

// The first height reading of a flight rescales the flow's world, and with it all lengths here.
void BestNavigator::update_scale(const NavigationEstimate& flow) {
  const RigidTransform world_from_initial = flow.world_from_initial * body_from_camera_;
  if (world_from_initial_) {
    const double factor = world_from_initial.translation.z() / world_from_initial_->translation.z();
    if (factor == 1) return;
    choice_.rescale(factor);
    initial_from_reference_.translation *= factor;
    initial_from_first_reference_.translation *= factor;
  }
  world_from_initial_ = world_from_initial;
}

// The output attitude is chained to the given initial attitude, the flow's is levelled by the
// ground. Its errors are correlated in time, so the vertical is replaced only at half the variance.
void BestNavigator::update_vertical(const NavigationEstimate& flow,
                                    const Eigen::Quaterniond& world_from_body) {
  constexpr double kMaxVarianceRatio = 0.5;
  if (flow.verdict != Verdict::ok || decision_.source != EstimateSource::flow) return;
  const double variance = flow.pose_covariance.diagonal().segment<2>(3).maxCoeff();
  if (decision_.position_error_bound > 0 || variance > kMaxVarianceRatio * up_variance_) return;
  up_in_world_ =
      world_from_body * (flow.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  up_variance_ = variance;
}

GravityAlignment BestNavigator::gravity_alignment(const Matrix6d& pose_covariance) const {
  const Eigen::Quaterniond alignment = rotation_between(up_in_world_, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d& initial_position = world_from_initial_->translation;
  return {.aligned_from_world = {alignment, initial_position - alignment * initial_position},
          .pose_covariance = rotate_covariance(pose_covariance, alignment),
          .sigma_rad = std::sqrt(up_variance_)};
}

EstimatePair BestNavigator::pair_of(const NavigationEstimate& flow,
                                    const NavigationEstimate& reference) const {
  const ReferenceReport& report = *reference.reference;
  EstimatePair pair{.flow = motion_from_initial(flow, *world_from_initial_, body_from_camera_),
                    .reference = report.motion,
                    .initial_from_reference = initial_from_reference_,
                    .relief_ratio = {},
                    .misfit_ratio = {},
                    .initial_height = world_from_initial_->translation.z()};
  const RigidTransform world_from_reference = *world_from_initial_ * initial_from_reference_;
  const Eigen::Vector3d normal =
      -(world_from_reference.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  const double sigma = std::max(kFeatureSigma_px, report.residual_px) / camera_.focal_x_px;
  const std::vector<BearingPair>& pairs = reference_.bearings().pairs;
  const RigidTransform initial_from_camera =
      decision_.initial_from_flow *
      RigidTransform{pair.flow.reference_from_camera, pair.flow.displacement_in_reference};
  pair.relief_ratio =
      ground_relief(pairs, reference_.inliers(), pose_from_motion(report.motion), normal, sigma);
  pair.misfit_ratio = ground_misfit(pairs, initial_from_camera.inverse() * initial_from_reference_,
                                    normal, world_from_reference.translation.z(), sigma);
  return pair;
}

NavigationEstimate BestNavigator::answer(const NavigationEstimate& flow,
                                         const NavigationEstimate& reference) const {
  const bool is_flow = decision_.source == EstimateSource::flow;
  NavigationEstimate out = is_flow ? flow : reference;
  const RigidTransform world_from_camera = *world_from_initial_ * decision_.initial_from_camera;
  out.world_from_body = world_from_camera * body_from_camera_.inverse();
  out.world_from_initial = flow.world_from_initial;
  if (is_flow) {
    const Eigen::Quaterniond& correction = decision_.initial_from_flow.rotation;
    const Eigen::Quaterniond& world = world_from_initial_->rotation;
    out.velocity_in_world_m_s = world_from_camera.rotation * flow.twist_in_camera.velocity_m_s;
    out.pose_covariance =
        rotate_covariance(flow.pose_covariance, world * correction * world.conjugate()) +
        rotate_covariance(decision_.correction_covariance, world);
    if (decision_.position_error_bound > 0) {
      const double height = world_from_initial_->translation.z();
      out.pose_covariance += scale_error_covariance(decision_.position_error_bound, height);
      out.twist_covariance +=
          scale_error_covariance(flow.twist_in_camera.velocity_m_s.norm(), height);
    }
  }
  return with_both_reports(std::move(out), flow, reference);
}

std::vector<WeightedFlow> BestNavigator::flow_vectors() const {
  if (decision_.source == EstimateSource::reference) return reference_.flow_vectors();
  return std::visit([](const auto& method) { return method.flow_vectors(); }, flow_);
}

}  // namespace stillkite
