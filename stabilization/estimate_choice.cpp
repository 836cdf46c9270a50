#include "stabilization/estimate_choice.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/chi_square.hpp"

namespace stillkite {
namespace {

bool is_finite_pose(const MotionEstimate& motion) {
  return motion.reference_from_camera.coeffs().allFinite() &&
         motion.displacement_in_reference.allFinite();
}

bool is_usable(const MotionEstimate& motion) {
  return motion.status == EstimateStatus::ok && is_finite_pose(motion) &&
         motion.rotation_covariance.allFinite() && motion.displacement_covariance.allFinite();
}

RigidTransform pose_of(const MotionEstimate& motion) {
  return {motion.reference_from_camera, motion.displacement_in_reference};
}

Eigen::Quaterniond rotation_by_reference(const EstimatePair& estimates) {
  return estimates.initial_from_reference.rotation * estimates.reference.reference_from_camera;
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& covariance, const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  return R * covariance * R.transpose();
}

// Chi-square test: e^T (P + sigma^2 I)^-1 e <= max_squared_error
bool is_within(const Eigen::Vector3d& error, const Eigen::Matrix3d& P, double extra_sigma,
               double max_squared_error) {
  const Eigen::LDLT<Eigen::Matrix3d> factors(P + extra_sigma * extra_sigma *
                                                     Eigen::Matrix3d::Identity());
  return factors.info() == Eigen::Success && error.dot(factors.solve(error)) <= max_squared_error;
}

// Part of a translation from the reference that contradicts the reference's direction: all of it
// if the reference is at rest or points the other way, else the part across the direction.
Eigen::Vector3d contradicted(const Eigen::Vector3d& translation_in_initial,
                             const EstimatePair& estimates) {
  const MotionEstimate& reference = estimates.reference;
  if (reference.displacement_kind == DisplacementKind::unknown) return Eigen::Vector3d::Zero();
  if (reference.displacement_kind == DisplacementKind::zero) return translation_in_initial;
  const Eigen::Vector3d direction = estimates.initial_from_reference.rotation *
                                    reference.displacement_in_reference.stableNormalized();
  return translation_in_initial - std::max(0.0, direction.dot(translation_in_initial)) * direction;
}

}  // namespace

EstimateChoice::EstimateChoice(const EstimateChoiceConfig& config)
    : config_(config), max_squared_error_(chi_square_at_sigmas(config.agreement_sigmas, 3)) {}

EstimateDecision EstimateChoice::step(const EstimatePair& estimates) {
  const bool is_flow_ok = is_usable(estimates.flow);
  const bool is_reference_ok = is_usable(estimates.reference);
  // 1. Continue a recovered flow from the decided position, not from its own prediction.
  if (is_flow_ok && !was_flow_ok_ && decision_.source == EstimateSource::reference) {
    resume_flow(estimates.flow);
  }
  // 2. A single usable estimate is selected at once, but no flow over ground that is not flat.
  if (is_flow_ok) test_flat_ground(estimates);
  if (is_flow_ok && is_reference_ok) {
    select(estimates);
  } else if (is_flow_ok || is_reference_ok) {
    const bool is_flow_allowed = is_flow_ok && is_flat_or_untested();
    set_source(is_flow_allowed ? EstimateSource::flow : EstimateSource::reference);
  }
  // 3. Pose: a lost flow predicts; with source reference the last translation is kept.
  const bool is_flow_selected = decision_.source == EstimateSource::flow;
  const RigidTransform flow = decision_.initial_from_flow * pose_of(estimates.flow);
  if (is_flow_ok) {
    decision_.initial_from_camera.translation = flow.translation;
    update_error_bound(estimates, flow);
  }
  if (is_flow_selected && is_finite_pose(estimates.flow)) decision_.initial_from_camera = flow;
  if (!is_flow_selected && is_reference_ok) {
    decision_.initial_from_camera.rotation = rotation_by_reference(estimates);
  }
  was_flow_ok_ = is_flow_ok;
  return decision_;
}

void EstimateChoice::rescale(double factor) {
  decision_.initial_from_camera.translation *= factor;
  decision_.initial_from_flow.translation *= factor;
  decision_.correction_covariance.topRows<3>() *= factor;
  decision_.correction_covariance.leftCols<3>() *= factor;
  decision_.position_error_bound *= factor;
  verified_position_ *= factor;
}

// Over ground of unknown relief, translation and rotation are ambiguous; the rotation difference to
// the reference bounds the error.
void EstimateChoice::update_error_bound(const EstimatePair& estimates, const RigidTransform& flow) {
  const bool is_verified = is_ground_flat_.value_or(false);
  if (is_verified) verified_position_ = flow.translation;
  const double displacement = (flow.translation - verified_position_).norm();
  const double rotation_rad =
      is_usable(estimates.reference)
          ? angle_between_rad(flow.rotation, rotation_by_reference(estimates))
          : 0;
  const double bound = std::max(displacement, estimates.initial_height * rotation_rad);
  decision_.position_error_bound =
      is_verified ? 0 : std::max(decision_.position_error_bound, bound);
}

// Keeps the last result if the parallax is too small for the test.
void EstimateChoice::test_flat_ground(const EstimatePair& estimates) {
  const auto is_flat = [&](const std::optional<double>& ratio) {
    return ratio && *ratio <= config_.max_relief_ratio;
  };
  is_flow_confirmed_ = is_flat(estimates.misfit_ratio);
  if (estimates.relief_ratio || is_flow_confirmed_) {
    is_ground_flat_ = is_flow_confirmed_ || is_flat(estimates.relief_ratio);
  }
}

// Both are ok: switches only after several consecutive frames in favour of the other estimator.
void EstimateChoice::select(const EstimatePair& estimates) {
  const bool was_flow_selected = decision_.source == EstimateSource::flow;
  // a flow that was interrupted, or is not confirmed, continues from the reference's pose
  if (!was_flow_ok_ && !is_flow_confirmed_) align_flow_to_reference(estimates);
  const bool is_consistent = is_flat_or_untested() && are_consistent(estimates);
  const bool is_flow_preferred = is_flow_confirmed_ || is_consistent;
  frames_for_other_ = is_flow_preferred == was_flow_selected ? 0 : frames_for_other_ + 1;
  const bool is_due = frames_for_other_ >= config_.patience_frames;
  if (is_due) set_source(was_flow_selected ? EstimateSource::reference : EstimateSource::flow);
  const bool is_flow_selected = decision_.source == EstimateSource::flow;
  if (is_flow_selected ? is_due && is_consistent : !is_flow_preferred) {
    align_flow_to_reference(estimates);
  }
}

bool EstimateChoice::are_consistent(const EstimatePair& estimates) const {
  const MotionEstimate& reference = estimates.reference;
  const Eigen::Quaterniond& initial_from_flow = decision_.initial_from_flow.rotation;
  const Eigen::Quaterniond& initial_from_reference = estimates.initial_from_reference.rotation;
  const RigidTransform flow = decision_.initial_from_flow * pose_of(estimates.flow);
  const Eigen::Vector3d rotation =
      so3_log(flow.rotation * rotation_by_reference(estimates).conjugate());
  const Eigen::Matrix3d rotation_covariance =
      rotated(estimates.flow.rotation_covariance, initial_from_flow) +
      rotated(reference.rotation_covariance, initial_from_reference);
  const Eigen::Vector3d translation =
      flow.translation - estimates.initial_from_reference.translation;
  const Eigen::Matrix3d translation_covariance =
      rotated(estimates.flow.displacement_covariance, initial_from_flow) +
      translation.squaredNorm() *
          rotated(reference.displacement_covariance, initial_from_reference);
  return is_within(rotation, rotation_covariance, config_.rotation_sigma_deg * kDegree,
                   max_squared_error_) &&
         is_within(contradicted(translation, estimates), translation_covariance,
                   config_.translation_sigma_ratio * estimates.initial_height, max_squared_error_);
}

// Corrects the flow to the reference's rotation and to the component d d^T c of its translation c
// along the reference's direction d. Its variance grows by the squared component across d.
void EstimateChoice::align_flow_to_reference(const EstimatePair& estimates) {
  const Eigen::Vector3d& origin = estimates.initial_from_reference.translation;
  const Eigen::Vector3d position =
      (decision_.initial_from_flow * pose_of(estimates.flow)).translation;
  const Eigen::Vector3d removed = contradicted(position - origin, estimates);
  const RigidTransform corrected{rotation_by_reference(estimates), position - removed};
  decision_.initial_from_flow = corrected * pose_of(estimates.flow).inverse();
  decision_.initial_from_flow.rotation.normalize();
  const bool is_at_origin = estimates.reference.displacement_kind == DisplacementKind::zero;
  const double variance =
      is_at_origin ? std::pow(config_.translation_sigma_ratio * estimates.initial_height, 2)
                   : decision_.correction_covariance(0, 0) + removed.squaredNorm();
  decision_.correction_covariance.diagonal().head<3>().setConstant(variance);
  decision_.correction_covariance.bottomRightCorner<3, 3>() =
      rotated(estimates.reference.rotation_covariance, estimates.initial_from_reference.rotation);
}

// What the camera has moved meanwhile is as uncertain as the difference is large.
void EstimateChoice::resume_flow(const MotionEstimate& flow) {
  const Eigen::Vector3d change = decision_.initial_from_camera.translation -
                                 (decision_.initial_from_flow * pose_of(flow)).translation;
  decision_.initial_from_flow.translation += change;
  decision_.correction_covariance.diagonal().head<3>().array() += change.squaredNorm();
}

void EstimateChoice::set_source(EstimateSource source) {
  decision_.source = source;
  frames_for_other_ = 0;
}

}  // namespace stillkite
