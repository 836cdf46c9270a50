#include "estimation/fusion/fusion_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

using Index = FusionIndex;

// Of what changes by the errors as J has it.
template <int kRows>
Eigen::Matrix<double, kRows, kRows> covariance_of(
    const Eigen::Matrix<double, kRows, Index::kLandmarks>& J, const Eigen::MatrixXd& P) {
  return J * P.topLeftCorner<Index::kLandmarks, Index::kLandmarks>() * J.transpose();
}

}  // namespace

FusionFilter::FusionFilter(const FusionConfig& config, const FusionStart& start)
    : config_(config),
      start_(config, start),
      start_in_world_(start.world_from_camera.translation),
      start_m_(start_in_world_),
      is_height_given_(start.log_unit_sigma == 0) {
  const int most = Index::kLandmarks + 3 * most_landmarks();
  P_ = Eigen::MatrixXd::Zero(most, most);
  landmarks_.reserve(static_cast<std::size_t>(most_landmarks()));
  state_.world_from_camera = state_.world_from_anchor = state_.world_from_keyframe =
      start.world_from_camera;
  state_.step_start = start_in_world_;
  const auto set = [this](int first, int count, double sigma) {
    P_.diagonal().segment(first, count).setConstant(square(sigma));
  };
  set(Index::kVelocity, 3, start.velocity_sigma);
  set(Index::kGyroBias, 3, config.gyro_bias_sigma_rad_s);
  set(Index::kAccelBias, 3, config.accel_bias_sigma_m_s2);
  set(Index::kTilt, 2, start.tilt_sigma_rad);
  set(Index::kScale, 1, config.scale_sigma_ratio);
  add_height_variance(square(config.height_sigma_ratio) + square(start.log_unit_sigma));
  prediction_ = {state_, own_covariance(), OwnMatrix::Identity()};
}

void FusionFilter::doubt_height(double sigma_ratio) {
  start_.remember([=](FusionFilter& filter) { filter.doubt_height(sigma_ratio); });
  add_height_variance(square(sigma_ratio));
}

// Of its metres, not of its units, exp(-(log_scale + log_height)): what shows of these later, as
// that depths were guessed too short, is to tell nothing of the height that was given.
void FusionFilter::add_height_variance(double variance) {
  P_.block<2, 2>(Index::kScale, Index::kScale) +=
      variance * (Eigen::Matrix2d() << 1, -1, -1, 1).finished();
}

int FusionFilter::size() const {
  return Index::landmark(landmarks_.size());
}

template <int kRows>
bool FusionFilter::correct(const Innovation<kRows>& innovation) {
  const int n = size();
  const Eigen::Matrix<double, Eigen::Dynamic, kRows> PHt = innovation.H.times_transposed(P_, n);
  const Eigen::Matrix<double, kRows, kRows> S = innovation.H.times(PHt) + innovation.noise;
  const Eigen::LLT<Eigen::Matrix<double, kRows, kRows>> factor(S);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::Matrix<double, kRows, 1> whitened = factor.matrixL().solve(innovation.residual);
  if (!(whitened.squaredNorm() <= square(config_.gate_sigma) * kRows)) return false;
  // K S K^T = A A^T with A = P H^T L^-T: what is taken off P is symmetric to the last bit
  const Eigen::Matrix<double, kRows, Eigen::Dynamic> A_t = factor.matrixL().solve(PHt.transpose());
  P_.topLeftCorner(n, n).noalias() -= A_t.transpose() * A_t;
  inject(A_t.transpose() * whitened);
  return true;
}

template bool FusionFilter::correct(const Innovation<1>&);
template bool FusionFilter::correct(const Innovation<2>&);
template bool FusionFilter::correct(const Innovation<3>&);
template bool FusionFilter::correct(const Innovation<6>&);

void FusionFilter::inject(const Eigen::VectorXd& error) {
  const auto turn = [&](RigidTransform& pose, int rotation, int position) {
    pose.rotation = (so3_exp(error.segment<3>(rotation)) * pose.rotation).normalized();
    pose.translation += error.segment<3>(position);
  };
  turn(state_.world_from_camera, Index::kRotation, Index::kPosition);
  turn(state_.world_from_anchor, Index::kAnchorRotation, Index::kAnchorPosition);
  turn(state_.world_from_keyframe, Index::kKeyframeRotation, Index::kKeyframePosition);
  state_.step_start += error.segment<3>(Index::kStepStart);
  state_.velocity_in_world += error.segment<3>(Index::kVelocity);
  state_.gyro_bias_rad_s += error.segment<3>(Index::kGyroBias);
  state_.accel_bias_m_s2 += error.segment<3>(Index::kAccelBias);
  state_.gravity_tilt_rad += error.segment<2>(Index::kTilt);
  state_.log_scale += error[Index::kScale];
  state_.log_height += error[Index::kHeight];
  int column = Index::kLandmarks;
  for (Landmark& landmark : landmarks_) {
    landmark.bearing += error.segment<2>(column);
    landmark.inverse_depth += error[column + 2];
    column += 3;
  }
}

bool FusionFilter::update_up(const Eigen::Vector3d& up_in_camera, double sigma_rad) {
  start_.remember([=](FusionFilter& filter) { filter.update_up(up_in_camera, sigma_rad); });
  // R up is exp(tilt) z: its level parts are (tilt_y, -tilt_x)
  const Eigen::Vector3d up = state_.world_from_camera.rotation * up_in_camera.normalized();
  Innovation<2> innovation{.residual = Eigen::Vector2d(up.x() - state_.gravity_tilt_rad.y(),
                                                       up.y() + state_.gravity_tilt_rad.x()),
                           .H = {},
                           .noise = square(sigma_rad) * Eigen::Matrix2d::Identity()};
  Eigen::Matrix2d by_tilt;
  by_tilt << 0, 1, -1, 0;
  innovation.H.add(Index::kTilt, by_tilt);
  innovation.H.add(Index::kRotation, skew(up).topRows<2>());
  return correct(innovation);
}

bool FusionFilter::update_turn(const Eigen::Quaterniond& anchor_from_camera,
                               const Eigen::Matrix3d& covariance) {
  start_.remember(
      [=](FusionFilter& filter) { filter.update_turn(anchor_from_camera, covariance); });
  const Eigen::Quaterniond from_anchor = state_.world_from_anchor.rotation.conjugate();
  const Eigen::Quaterniond expected = from_anchor * state_.world_from_camera.rotation;
  const Eigen::Matrix3d in_anchor = from_anchor.toRotationMatrix();
  Innovation<3> innovation{
      .residual = so3_log(anchor_from_camera * expected.conjugate()), .H = {}, .noise = covariance};
  innovation.H.add(Index::kRotation, in_anchor);
  innovation.H.add(Index::kAnchorRotation, -in_anchor);
  return correct(innovation);
}

void FusionFilter::begin_step() {
  start_.begin_frame();
  start_.remember([](FusionFilter& filter) { filter.begin_step(); });
  state_.step_start = state_.world_from_camera.translation;
  step_s_ = gyro_s_ = 0;
  has_accel_ = has_leapt_ = false;
  clone(Index::kPosition, 3, Index::kStepStart);
  prediction_ = {state_, own_covariance(), OwnMatrix::Identity()};
}

// What is a copy has the original's errors, and their covariance with all others.
void FusionFilter::clone(int original, int count, int copy) {
  const int n = size();
  P_.block(copy, 0, count, n) = P_.block(original, 0, count, n).eval();
  P_.block(0, copy, n, count) = P_.block(0, original, n, count).eval();
}

RigidTransform FusionFilter::world_from_camera_m() const {
  // the first frame stays where it was said to be
  const double scale = std::exp(state_.log_scale);
  return {state_.world_from_camera.rotation,
          start_m_ + scale * (state_.world_from_camera.translation - start_in_world_)};
}

Eigen::Vector3d FusionFilter::velocity_in_world_m_s() const {
  return std::exp(state_.log_scale) * state_.velocity_in_world;
}

Eigen::Vector3d FusionFilter::step_m() const {
  return std::exp(state_.log_scale) * (state_.world_from_camera.translation - state_.step_start);
}

// With c = s R^T w, w = p - p_b, and R c is what is asked for: s (e_p - e_b + [w]x e + w e_s).
Eigen::Matrix3d FusionFilter::step_covariance() const {
  const double s = std::exp(state_.log_scale);
  const Eigen::Vector3d way = state_.world_from_camera.translation - state_.step_start;
  Eigen::Matrix<double, 3, Index::kLandmarks> J;
  J.setZero();
  J.middleCols<3>(Index::kRotation) = s * skew(way);
  J.middleCols<3>(Index::kPosition).diagonal().setConstant(s);
  J.middleCols<3>(Index::kStepStart).diagonal().setConstant(-s);
  J.col(Index::kScale) = s * way;
  return covariance_of(J, P_);
}

// d(translation in m, rotation vector) by the errors, world axes.
FusionFilter::PoseRows FusionFilter::pose_rows() const {
  PoseRows J = PoseRows::Zero();
  J.block<3, 3>(0, Index::kPosition).diagonal().setConstant(std::exp(state_.log_scale));
  J.block<3, 1>(0, Index::kScale) = world_from_camera_m().translation - start_m_;
  J.block<3, 3>(3, Index::kRotation).setIdentity();
  return J;
}

Matrix6d FusionFilter::pose_covariance() const {
  return covariance_of(pose_rows(), P_);
}

RigidTransform FusionFilter::aligned_from_world() const {
  const Eigen::Quaterniond turn = rotation_between(up(state_), Eigen::Vector3d::UnitZ());
  return {turn, start_m_ - turn * start_m_};
}

// With u the vertical, e_u its error and U the turn that takes u to z: the true one is U exp(-l),
// l = u x e_u / u^2. So turns err by U (e - l), and a way w by U (e_w + [w]x l).
Matrix6d FusionFilter::upright_pose_covariance() const {
  const Eigen::Vector3d u = up(state_);
  Eigen::Matrix<double, 3, 2> u_by_tilt;
  u_by_tilt << 0, 1, -1, 0, 0, 0;
  const Eigen::Matrix<double, 3, 2> lean = skew(u) * u_by_tilt / u.squaredNorm();
  PoseRows J = pose_rows();
  J.block<3, 2>(0, Index::kTilt) = skew(world_from_camera_m().translation - start_m_) * lean;
  J.block<3, 2>(3, Index::kTilt) = -lean;
  const Eigen::Matrix3d U = aligned_from_world().rotation.toRotationMatrix();
  J.topRows<3>() = (U * J.topRows<3>()).eval();
  J.bottomRows<3>() = (U * J.bottomRows<3>()).eval();
  return covariance_of(J, P_);
}

RigidTransform FusionFilter::anchor_from_camera_m() const {
  RigidTransform seen = state_.world_from_anchor.inverse() * state_.world_from_camera;
  seen.translation *= std::exp(state_.log_scale);
  return seen;
}

// With c = s R_a^T (p - p_a): R_a^T (e_p - e_pa + [p - p_a]x e_a) s + c e_s; turns: R_a^T (e -
// e_a).
Matrix6d FusionFilter::anchored_covariance() const {
  const RigidTransform& anchor = state_.world_from_anchor;
  const Eigen::Matrix3d R_t = anchor.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d in_m = std::exp(state_.log_scale) * R_t;
  const Eigen::Vector3d way = state_.world_from_camera.translation - anchor.translation;
  PoseRows J = PoseRows::Zero();
  J.block<3, 3>(0, Index::kPosition) = in_m;
  J.block<3, 3>(0, Index::kAnchorPosition) = -in_m;
  J.block<3, 3>(0, Index::kAnchorRotation) = in_m * skew(way);
  J.block<3, 1>(0, Index::kScale) = in_m * way;
  J.block<3, 3>(3, Index::kRotation) = R_t;
  J.block<3, 3>(3, Index::kAnchorRotation) = -R_t;
  return covariance_of(J, P_);
}

Eigen::Matrix3d FusionFilter::velocity_covariance() const {
  Eigen::Matrix<double, 3, Index::kLandmarks> J;
  J.setZero();
  J.middleCols<3>(Index::kVelocity).diagonal().setConstant(std::exp(state_.log_scale));
  J.col(Index::kScale) = velocity_in_world_m_s();
  return covariance_of(J, P_);
}

double FusionFilter::up_sigma_rad() const {
  return std::sqrt(P_.diagonal().segment<2>(Index::kTilt).maxCoeff());
}

double FusionFilter::scale_sigma() const {
  return std::sqrt(std::max(0.0, P_(Index::kScale, Index::kScale)));
}

}  // namespace stillkite
