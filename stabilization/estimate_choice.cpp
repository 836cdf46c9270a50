#include "stabilization/estimate_choice.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/angle.hpp"

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
  return estimates.start_from_reference.rotation * estimates.reference.reference_from_camera;
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  return R * covariance * R.transpose();
}

// e^T (P + floor^2 I)^-1 e <= k^2
bool is_within(const Eigen::Vector3d& error, const Eigen::Matrix3d& P, double floor,
               double sigmas) {
  const Eigen::LDLT<Eigen::Matrix3d> factors(P + floor * floor * Eigen::Matrix3d::Identity());
  return factors.info() == Eigen::Success && error.dot(factors.solve(error)) <= sigmas * sigmas;
}

// Of a way from the reference what the reference contradicts: all of it where the reference has not
// moved or has gone the other way, else what is across its direction.
Eigen::Vector3d contradicted(const Eigen::Vector3d& way_in_start, const EstimatePair& estimates) {
  const MotionEstimate& reference = estimates.reference;
  if (reference.displacement_kind == DisplacementKind::unknown) return Eigen::Vector3d::Zero();
  if (reference.displacement_kind == DisplacementKind::zero) return way_in_start;
  const Eigen::Vector3d direction = estimates.start_from_reference.rotation *
                                    reference.displacement_in_reference.stableNormalized();
  return way_in_start - std::max(0.0, direction.dot(way_in_start)) * direction;
}

}  // namespace

EstimateDecision EstimateChoice::step(const EstimatePair& estimates) {
  const bool is_flow_ok = is_usable(estimates.flow);
  const bool is_reference_ok = is_usable(estimates.reference);
  // 1. The flow goes on from the answers given meanwhile, not from where it had coasted.
  if (is_flow_ok && !was_flow_ok_ && decision_.source == EstimateSource::reference) {
    resume_flow(estimates.flow);
  }
  // 2. Who is alone is taken at once; not a flow that takes a scene with depth for flat ground.
  if (is_flow_ok) judge_ground(estimates);
  if (is_flow_ok && is_reference_ok) {
    choose(estimates);
  } else if (is_flow_ok || is_reference_ok) {
    const bool is_flow_taken = is_flow_ok && may_be_flat();
    take(is_flow_taken ? EstimateSource::flow : EstimateSource::reference);
  }
  // 3. Where the camera is by it: a lost flow predicts, the reference's place is carried on.
  const bool is_flow_chosen = decision_.source == EstimateSource::flow;
  const RigidTransform flow = decision_.home_from_flow * pose_of(estimates.flow);
  if (is_flow_ok) {
    decision_.start_from_camera.translation = flow.translation;
    doubt(estimates, flow);
  }
  if (is_flow_chosen && is_finite_pose(estimates.flow)) decision_.start_from_camera = flow;
  if (!is_flow_chosen && is_reference_ok) {
    decision_.start_from_camera.rotation = rotation_by_reference(estimates);
  }
  was_flow_ok_ = is_flow_ok;
  return decision_;
}

void EstimateChoice::stretch(double factor) {
  decision_.start_from_camera.translation *= factor;
  decision_.home_from_flow.translation *= factor;
  decision_.correction_covariance.topRows<3>() *= factor;
  decision_.correction_covariance.leftCols<3>() *= factor;
  decision_.unproven_way *= factor;
  proven_place_ *= factor;
}

// Over unknown ground a way may be taken for a turn, and a turn for a way: what the reference says
// of the turn tells how far.
void EstimateChoice::doubt(const EstimatePair& estimates, const RigidTransform& flow) {
  const bool is_proven = is_ground_flat_.value_or(false);
  if (is_proven) proven_place_ = flow.translation;
  const double way = (flow.translation - proven_place_).norm();
  const double turn_rad = is_usable(estimates.reference)
                              ? angle_between_rad(flow.rotation, rotation_by_reference(estimates))
                              : 0;
  const double unproven = std::max(way, estimates.start_height * turn_rad);
  decision_.unproven_way = is_proven ? 0 : std::max(decision_.unproven_way, unproven);
}

// What too little parallax leaves open is as it was.
void EstimateChoice::judge_ground(const EstimatePair& estimates) {
  const auto shows_flat_ground = [&](const std::optional<double>& ratio) {
    return ratio && *ratio <= config_.max_relief_ratio;
  };
  is_flow_seen_ = shows_flat_ground(estimates.misfit_ratio);
  if (estimates.relief_ratio || is_flow_seen_) {
    is_ground_flat_ = is_flow_seen_ || shows_flat_ground(estimates.relief_ratio);
  }
}

// Both are ok: the other one has to be the better for some frames in a row.
void EstimateChoice::choose(const EstimatePair& estimates) {
  const bool is_flow_chosen = decision_.source == EstimateSource::flow;
  // a flow that was interrupted, or is not believed, goes on from what the reference says
  if (!was_flow_ok_ && !is_flow_seen_) hand_over(estimates);
  const bool does_agree = may_be_flat() && agree(estimates);
  const bool is_flow_preferred = is_flow_seen_ || does_agree;
  frames_for_other_ = is_flow_preferred == is_flow_chosen ? 0 : frames_for_other_ + 1;
  const bool is_due = frames_for_other_ >= config_.patience_frames;
  if (is_due) take(is_flow_chosen ? EstimateSource::reference : EstimateSource::flow);
  const bool is_flow_taken = decision_.source == EstimateSource::flow;
  if (is_flow_taken ? is_due && does_agree : !is_flow_preferred) hand_over(estimates);
}

bool EstimateChoice::agree(const EstimatePair& estimates) const {
  const MotionEstimate& reference = estimates.reference;
  const Eigen::Quaterniond& turn_of_flow = decision_.home_from_flow.rotation;
  const Eigen::Quaterniond& turn_of_reference = estimates.start_from_reference.rotation;
  const RigidTransform flow = decision_.home_from_flow * pose_of(estimates.flow);
  const Eigen::Vector3d turn =
      so3_log(flow.rotation * rotation_by_reference(estimates).conjugate());
  const Eigen::Matrix3d turn_covariance = turned(estimates.flow.rotation_covariance, turn_of_flow) +
                                          turned(reference.rotation_covariance, turn_of_reference);
  const Eigen::Vector3d way = flow.translation - estimates.start_from_reference.translation;
  const Eigen::Matrix3d way_covariance =
      turned(estimates.flow.displacement_covariance, turn_of_flow) +
      way.squaredNorm() * turned(reference.displacement_covariance, turn_of_reference);
  return is_within(turn, turn_covariance, config_.rotation_sigma_deg * kDegree,
                   config_.agreement_sigmas) &&
         is_within(contradicted(way, estimates), way_covariance,
                   config_.way_sigma_ratio * estimates.start_height, config_.agreement_sigmas);
}

// Rotation as the reference has it; of the way what it does not contradict, d d^T c along its
// direction. That part is believed no better than the part across was wrong.
void EstimateChoice::hand_over(const EstimatePair& estimates) {
  const Eigen::Vector3d& origin = estimates.start_from_reference.translation;
  const Eigen::Vector3d place = (decision_.home_from_flow * pose_of(estimates.flow)).translation;
  const Eigen::Vector3d dropped = contradicted(place - origin, estimates);
  const RigidTransform wanted{rotation_by_reference(estimates), place - dropped};
  decision_.home_from_flow = wanted * pose_of(estimates.flow).inverse();
  decision_.home_from_flow.rotation.normalize();
  const bool is_at_origin = estimates.reference.displacement_kind == DisplacementKind::zero;
  const double variance = is_at_origin
                              ? std::pow(config_.way_sigma_ratio * estimates.start_height, 2)
                              : decision_.correction_covariance(0, 0) + dropped.squaredNorm();
  decision_.correction_covariance.diagonal().head<3>().setConstant(variance);
  decision_.correction_covariance.bottomRightCorner<3, 3>() =
      turned(estimates.reference.rotation_covariance, estimates.start_from_reference.rotation);
}

void EstimateChoice::resume_flow(const MotionEstimate& flow) {
  decision_.home_from_flow.translation += decision_.start_from_camera.translation -
                                          (decision_.home_from_flow * pose_of(flow)).translation;
}

void EstimateChoice::take(EstimateSource source) {
  decision_.source = source;
  frames_for_other_ = 0;
}

}  // namespace stillkite
