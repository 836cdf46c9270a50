#include "estimation/fusion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr double kGravity_m_s2 = 9.80665;
constexpr int kMostRefusals = 5;
constexpr double kAnySpeed_m_s = 100;
constexpr double kAnyRateDensity = 0.5;  // rad/s/sqrt(Hz)

// Accelerometers feel its opposite. The world's vertical is off by the tilt: exp(tilt) z.
Eigen::Vector3d gravity_m_s2(const Eigen::Vector2d& tilt_rad) {
  return -kGravity_m_s2 * Eigen::Vector3d(tilt_rad.y(), -tilt_rad.x(), 1);
}

Eigen::Matrix<double, 3, 2> gravity_by_tilt() {
  Eigen::Matrix<double, 3, 2> J;
  J << 0, -kGravity_m_s2, kGravity_m_s2, 0, 0, 0;
  return J;
}

double square(double x) {
  return x * x;
}

constexpr double kSameLevel = 0.04;

// The largest height on which, within kSameLevel of it, several lie; that of their middle.
std::optional<double> lowest_level(std::vector<double> heights) {
  constexpr std::size_t kSeveral = 5;
  std::sort(heights.begin(), heights.end());
  for (std::size_t last = heights.size(); last-- > kSeveral - 1;) {
    const double highest = heights[last + 1 - kSeveral];
    if (highest > (1 - kSameLevel) * heights[last]) return heights[last - kSeveral / 2];
  }
  return std::nullopt;
}

// Of position and velocity (Bar-Shalom et al. 2001, eq. 6.2.2-12), the density squared.
Eigen::Matrix<double, 9, 9> white_acceleration(double squared_density, double dt_s) {
  Eigen::Matrix<double, 9, 9> Q = Eigen::Matrix<double, 9, 9>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int p = Index::kPosition + i;
    const int v = Index::kVelocity + i;
    Q(p, p) = squared_density * dt_s * dt_s * dt_s / 3;
    Q(p, v) = Q(v, p) = squared_density * dt_s * dt_s / 2;
    Q(v, v) = squared_density * dt_s;
  }
  return Q;
}

struct Carried {
  Eigen::Vector3d rate_rad_s;
  Eigen::Vector3d force_in_world_m_s2;  // without gravity
};

Carried carried(const FusionState& state, const InertialStep& step) {
  Carried out{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  if (step.angular_rate_rad_s) out.rate_rad_s = *step.angular_rate_rad_s;
  if (step.is_gyro && step.angular_rate_rad_s) out.rate_rad_s -= state.gyro_bias_rad_s;
  if (step.specific_force_m_s2) {
    out.force_in_world_m_s2 =
        state.world_from_camera.rotation * (*step.specific_force_m_s2 - state.accel_bias_m_s2);
  }
  return out;
}

FusionState moved(const FusionState& state, const InertialStep& step) {
  const Carried by = carried(state, step);
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  if (step.specific_force_m_s2) {
    acceleration = std::exp(-state.log_scale) *
                   (by.force_in_world_m_s2 + gravity_m_s2(state.gravity_tilt_rad));
  }
  FusionState next = state;
  next.world_from_camera.rotation =
      (state.world_from_camera.rotation * so3_exp(by.rate_rad_s * step.dt_s)).normalized();
  next.world_from_camera.translation +=
      state.velocity_in_world * step.dt_s + 0.5 * square(step.dt_s) * acceleration;
  next.velocity_in_world += acceleration * step.dt_s;
  return next;
}

}  // namespace

FusionFilter::FusionFilter(const FusionConfig& config, const RigidTransform& world_from_camera,
                           double velocity_sigma_m_s)
    : config_(config), start_in_world_(world_from_camera.translation) {
  const int most = Index::kLandmarks + 3 * config.landmarks;
  P_ = Eigen::MatrixXd::Zero(most, most);
  landmarks_.reserve(static_cast<std::size_t>(config.landmarks));
  state_.world_from_camera = state_.world_from_anchor = world_from_camera;
  const auto set = [this](int first, int count, double sigma) {
    P_.diagonal().segment(first, count).setConstant(square(sigma));
  };
  set(Index::kVelocity, 3, velocity_sigma_m_s);
  set(Index::kGyroBias, 3, config.gyro_bias_sigma_rad_s);
  set(Index::kAccelBias, 3, config.accel_bias_sigma_m_s2);
  set(Index::kTilt, 2, config.tilt_sigma_rad);
  set(Index::kScale, 1, config.scale_sigma_ratio);
  set(Index::kHeight, 1, config.height_sigma_ratio);
}

int FusionFilter::size() const {
  return Index::kLandmarks + 3 * static_cast<int>(landmarks_.size());
}

void FusionFilter::predict(const InertialStep& step) {
  const double dt_s = step.dt_s;
  const bool has_gyro = step.angular_rate_rad_s && step.is_gyro;
  const bool has_accel = step.specific_force_m_s2.has_value();
  const Eigen::Matrix3d R = state_.world_from_camera.rotation.toRotationMatrix();
  const Carried by = carried(state_, step);
  const double shrink = std::exp(-state_.log_scale);

  Transition F = Transition::Identity();
  F.block<3, 3>(Index::kPosition, Index::kVelocity).diagonal().setConstant(dt_s);
  if (has_gyro) F.block<3, 3>(Index::kRotation, Index::kGyroBias) = -dt_s * R;
  if (has_accel) {
    const double in_map_s = shrink * dt_s;
    Eigen::Matrix<double, 3, Index::kAnchorRotation> by_force;
    by_force.setZero();
    by_force.middleCols<3>(Index::kRotation) = -in_map_s * skew(by.force_in_world_m_s2);
    by_force.middleCols<3>(Index::kAccelBias) = -in_map_s * R;
    by_force.middleCols<2>(Index::kTilt) = in_map_s * gravity_by_tilt();
    by_force.col(Index::kScale) =
        -in_map_s * (by.force_in_world_m_s2 + gravity_m_s2(state_.gravity_tilt_rad));
    F.middleRows<3>(Index::kVelocity) += by_force;
    F.middleRows<3>(Index::kPosition) += 0.5 * dt_s * by_force;
  }
  const double rate_density = has_gyro                  ? config_.gyro_density
                              : step.angular_rate_rad_s ? config_.rate_density
                                                        : kAnyRateDensity;
  const double accel_density = has_accel ? config_.accel_density : config_.acceleration_density;
  Matrix9d noise = white_acceleration(square(shrink * accel_density), dt_s);
  noise.diagonal().segment<3>(Index::kRotation).setConstant(square(rate_density) * dt_s);
  propagate(F, noise, dt_s);
  state_ = moved(state_, step);
}

// With s = exp(-(log_scale + log_height)): p' = p + s R t, R' = R dR
void FusionFilter::predict_by_odometry(const RigidTransform& before_from_now_m, double dt_s,
                                       const Matrix6d& growth) {
  const double shrink = std::exp(-(state_.log_scale + state_.log_height));
  RigidTransform& camera = state_.world_from_camera;
  const Eigen::Vector3d way = shrink * (camera.rotation * before_from_now_m.translation);
  Transition F = Transition::Identity();
  F.block<3, 3>(Index::kPosition, Index::kRotation) = -skew(way);
  F.col(Index::kScale).segment<3>(Index::kPosition) = -way;
  F.col(Index::kHeight).segment<3>(Index::kPosition) = -way;
  Matrix9d noise = Matrix9d::Zero();
  noise.block<3, 3>(Index::kRotation, Index::kRotation) = growth.bottomRightCorner<3, 3>();
  noise.block<3, 3>(Index::kPosition, Index::kPosition) =
      square(shrink) * growth.topLeftCorner<3, 3>();
  noise.block<3, 3>(Index::kPosition, Index::kRotation) = shrink * growth.topRightCorner<3, 3>();
  noise.block<3, 3>(Index::kRotation, Index::kPosition) = shrink * growth.bottomLeftCorner<3, 3>();
  // the velocity carries nothing on here: the flow's own, which is filtered, takes its place
  F.middleRows<3>(Index::kVelocity).setZero();
  noise.diagonal().segment<3>(Index::kVelocity).setConstant(square(shrink * kAnySpeed_m_s));
  propagate(F, noise, dt_s);
  camera.translation += way;
  camera.rotation = (camera.rotation * before_from_now_m.rotation).normalized();
}

void FusionFilter::propagate(const Transition& F, const Matrix9d& noise, double dt_s) {
  const int n = size();
  const Eigen::MatrixXd rows = F * P_.topLeftCorner(Index::kAnchorRotation, n);
  P_.topLeftCorner(9, n) = rows;
  P_.topLeftCorner(n, 9) = rows.transpose();
  P_.topLeftCorner<9, 9>() = rows.leftCols<Index::kAnchorRotation>() * F.transpose() + noise;
  P_.diagonal().segment<3>(Index::kGyroBias).array() += square(config_.gyro_bias_walk) * dt_s;
  P_.diagonal().segment<3>(Index::kAccelBias).array() += square(config_.accel_bias_walk) * dt_s;
}

FusionState FusionFilter::predicted(const std::vector<InertialStep>& steps) const {
  FusionState state = state_;
  for (const InertialStep& step : steps) state = moved(state, step);
  return state;
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

void FusionFilter::inject(const Eigen::VectorXd& error) {
  const auto turn = [&](RigidTransform& pose, int rotation, int position) {
    pose.rotation = (so3_exp(error.segment<3>(rotation)) * pose.rotation).normalized();
    pose.translation += error.segment<3>(position);
  };
  turn(state_.world_from_camera, Index::kRotation, Index::kPosition);
  turn(state_.world_from_anchor, Index::kAnchorRotation, Index::kAnchorPosition);
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

bool FusionFilter::update_flow_velocity(const Eigen::Vector3d& velocity_m_s,
                                        const Eigen::Matrix3d& covariance) {
  // the flow's metres are true ones times exp(log_height)
  const double scale = std::exp(state_.log_scale + state_.log_height);
  const Eigen::Matrix3d R_t = state_.world_from_camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d h = scale * (R_t * state_.velocity_in_world);
  Innovation<3> innovation{.residual = velocity_m_s - h,
                           .H = {},
                           .noise = covariance + square(config_.flow_velocity_sigma_ratio) *
                                                     velocity_m_s.squaredNorm() *
                                                     Eigen::Matrix3d::Identity()};
  innovation.H.add(Index::kRotation, scale * R_t * skew(state_.velocity_in_world));
  innovation.H.add(Index::kVelocity, scale * R_t);
  innovation.H.add(Index::kScale, h * Eigen::RowVector2d::Ones());
  return correct(innovation);
}

bool FusionFilter::update_up(const Eigen::Vector3d& up_in_camera) {
  // R up is exp(tilt) z: its level parts are (tilt_y, -tilt_x)
  const Eigen::Vector3d up = state_.world_from_camera.rotation * up_in_camera.normalized();
  Innovation<2> innovation{
      .residual = Eigen::Vector2d(up.x() - state_.gravity_tilt_rad.y(),
                                  up.y() + state_.gravity_tilt_rad.x()),
      .H = {},
      .noise = square(config_.attitude_sigma_rad) * Eigen::Matrix2d::Identity()};
  Eigen::Matrix2d by_tilt;
  by_tilt << 0, 1, -1, 0;
  innovation.H.add(Index::kTilt, by_tilt);
  innovation.H.add(Index::kRotation, skew(up).topRows<2>());
  return correct(innovation);
}

void FusionFilter::take_anchor() {
  landmarks_.clear();
  state_.world_from_anchor = state_.world_from_camera;
  const int n = Index::kLandmarks;
  P_.block<6, Index::kAnchorRotation>(Index::kAnchorRotation, 0) =
      P_.block<6, Index::kAnchorRotation>(Index::kRotation, 0);
  P_.block<Index::kAnchorRotation, 6>(0, Index::kAnchorRotation) =
      P_.block<6, Index::kAnchorRotation>(Index::kAnchorRotation, 0).transpose();
  P_.block<6, 6>(Index::kAnchorRotation, Index::kAnchorRotation) =
      P_.block<6, 6>(Index::kRotation, Index::kRotation);
  static_assert(n == Index::kAnchorRotation + 6);
}

// The ground, where the line of sight meets it within a dozen heights; else as far as that.
double FusionFilter::guessed_inverse_depth(const Eigen::Vector2d& bearing) const {
  constexpr double kSteepness = 0.3;
  const RigidTransform& anchor = state_.world_from_anchor;
  const double down = -(anchor.rotation * bearing.homogeneous()).z();
  return std::max(down, kSteepness) / std::max(anchor.translation.z(), 1e-3);
}

void FusionFilter::add_landmark(int feature, const Eigen::Vector2d& bearing, double sigma) {
  if (static_cast<int>(landmarks_.size()) >= config_.landmarks) return;
  const int column = size();
  const double inverse_depth = guessed_inverse_depth(bearing);
  landmarks_.push_back({.feature = feature, .bearing = bearing, .inverse_depth = inverse_depth});
  P_.block(column, 0, 3, column + 3).setZero();
  P_.block(0, column, column, 3).setZero();
  P_(column, column) = P_(column + 1, column + 1) = square(sigma);
  P_(column + 2, column + 2) = square(config_.inverse_depth_sigma_ratio * inverse_depth);
}

bool FusionFilter::update_landmark(int feature, const Eigen::Vector2d& seen, double sigma) {
  const auto found = std::find_if(landmarks_.begin(), landmarks_.end(),
                                  [&](const Landmark& l) { return l.feature == feature; });
  if (found == landmarks_.end()) return false;
  const int column = Index::kLandmarks + 3 * static_cast<int>(found - landmarks_.begin());
  const std::optional<Innovation<2>> innovation =
      landmark_innovation(state_, *found, column, seen, sigma);
  const bool taken = innovation && correct(*innovation);
  found->refused = taken ? 0 : found->refused + 1;
  return taken;
}

// Map units.
double FusionFilter::height_below_anchor(const Landmark& landmark) const {
  const double down = -(state_.world_from_anchor.rotation * landmark.bearing.homogeneous()).z();
  return down / landmark.inverse_depth;
}

int FusionFilter::update_ground() {
  // 1. Landmarks below the camera whose depth has shown.
  constexpr double kSteepness = 0.1;
  constexpr double kKnown = 0.1;
  std::vector<double> heights;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const int column = Index::kLandmarks + 3 * static_cast<int>(i) + 2;
    const double inverse_depth = landmarks_[i].inverse_depth;
    if (!(inverse_depth > 0) || P_(column, column) > square(kKnown * inverse_depth)) continue;
    const double height = height_below_anchor(landmarks_[i]);
    if (height * inverse_depth < kSteepness) continue;
    heights.push_back(height);
    candidates.push_back(i);
  }
  // 2. Nothing is below the ground: it is the lowest level on which several of them lie.
  const std::optional<double> ground = lowest_level(heights);
  if (!ground) return 0;
  // 3. So high the anchor is, by what is known of the start and the way since.
  int count = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    Landmark& landmark = landmarks_[candidates[c]];
    if (landmark.is_on_ground || std::abs(heights[c] / *ground - 1) > kSameLevel) continue;
    const int column = Index::kLandmarks + 3 * static_cast<int>(candidates[c]);
    landmark.is_on_ground = correct(ground_innovation(landmark, column));
    if (landmark.is_on_ground) ++count;
  }
  return count;
}

// h0 exp(-log_height) + s (z_a - z_0) = s down / inverse_depth, s = exp(log_scale)
Innovation<1> FusionFilter::ground_innovation(const Landmark& landmark, int column) const {
  using Row = Eigen::Matrix<double, 1, 1>;
  const double scale = std::exp(state_.log_scale);
  const double known = start_in_world_.z() * std::exp(-state_.log_height);
  const double way = scale * (state_.world_from_anchor.translation.z() - start_in_world_.z());
  const double below = scale * height_below_anchor(landmark);
  Innovation<1> innovation{.residual = Row(known + way - below),
                           .H = {},
                           .noise = Row(square(config_.ground_sigma_ratio * known))};
  const Eigen::Matrix3d R = state_.world_from_anchor.rotation.toRotationMatrix();
  const double per_down = scale / landmark.inverse_depth;
  const Eigen::RowVector3d by_rotation = per_down * skew(R * landmark.bearing.homogeneous()).row(2);
  innovation.H.add(Index::kScale, Eigen::RowVector2d(below - way, known));
  innovation.H.add(Index::kAnchorPosition, Eigen::RowVector3d(0, 0, -scale));
  innovation.H.add(Index::kAnchorRotation, by_rotation);
  innovation.H.add(column, Eigen::RowVector3d(-per_down * R(2, 0), -per_down * R(2, 1),
                                              -below / landmark.inverse_depth));
  return innovation;
}

void FusionFilter::drop_refused() {
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    if (landmarks_[i].refused >= kMostRefusals) remove_landmark(i);
  }
}

void FusionFilter::remove_landmark(std::size_t i) {
  const int n = size();
  const int column = Index::kLandmarks + 3 * static_cast<int>(i);
  const int after = n - column - 3;
  P_.block(column, 0, after, n) = P_.block(column + 3, 0, after, n).eval();
  P_.block(0, column, n, after) = P_.block(0, column + 3, n, after).eval();
  landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(i));
}

RigidTransform FusionFilter::world_from_camera_m() const {
  // the first frame stays where it was said to be
  const double scale = std::exp(state_.log_scale);
  return {state_.world_from_camera.rotation,
          start_in_world_ + scale * (state_.world_from_camera.translation - start_in_world_)};
}

Eigen::Vector3d FusionFilter::velocity_in_world_m_s() const {
  return std::exp(state_.log_scale) * state_.velocity_in_world;
}

// Of exp(log_scale) * value.
Eigen::Matrix3d FusionFilter::metric_covariance(int first, const Eigen::Vector3d& value) const {
  const Eigen::Vector3d cross = P_.block<3, 1>(first, Index::kScale);
  return std::exp(2 * state_.log_scale) *
         (P_.block<3, 3>(first, first) + cross * value.transpose() + value * cross.transpose() +
          P_(Index::kScale, Index::kScale) * value * value.transpose());
}

Matrix6d FusionFilter::pose_covariance() const {
  const Eigen::Vector3d way = state_.world_from_camera.translation - start_in_world_;
  const Eigen::Matrix3d cross =
      std::exp(state_.log_scale) * (P_.block<3, 3>(Index::kPosition, Index::kRotation) +
                                    way * P_.block<1, 3>(Index::kScale, Index::kRotation));
  Matrix6d C;
  C << metric_covariance(Index::kPosition, way), cross, cross.transpose(),
      P_.block<3, 3>(Index::kRotation, Index::kRotation);
  return C;
}

Eigen::Matrix3d FusionFilter::velocity_covariance() const {
  return metric_covariance(Index::kVelocity, state_.velocity_in_world);
}

double FusionFilter::scale_sigma() const {
  return std::sqrt(std::max(0.0, P_(Index::kScale, Index::kScale)));
}

}  // namespace stillkite
