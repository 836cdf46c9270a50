#include "estimation/fusion/landmark_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "estimation/ego_motion/integration.hpp"
#include "estimation/fusion/innovation_consensus.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {

LandmarkFilter::LandmarkFilter(const LandmarkFilterConfig& config,
                               std::span<const KnownLandmark> map,
                               const RigidTransform& world_from_camera, const Matrix6d& covariance)
    : config_(config), state_{.camera = world_from_camera} {
  map_.reserve(map.size());
  for (const KnownLandmark& known : map) {
    if (!known.position_in_world_m.allFinite() || !known.covariance_m2.allFinite() ||
        known.covariance_m2.llt().info() != Eigen::Success) {
      throw InputError("landmark " + std::to_string(map_.size()) +
                       ": its covariance is not positive definite; tell how well it is known");
    }
    map_.push_back({.known = known});
  }
  const int most = kLandmarks + 3 * config.most_landmarks;
  P_ = Eigen::MatrixXd::Zero(most, most);
  P_.topLeftCorner<6, 6>() = covariance;
  P_.diagonal().segment<3>(kBias).setConstant(square(config.velocity_bias_sigma_m_s));
  P_.diagonal().segment<3>(kBias + 3).setConstant(square(config.rate_bias_sigma_rad_s));
}

// With u = seen - bias: p' = p + R J v dt, R' = R exp(w dt); errors in world axes,
//   e_p' = e_p - [p' - p]x e_R - R (e_bv + n_v) dt,  e_R' = e_R - R (e_bw + n_w) dt,
// and the bias fades as a first-order Gauss-Markov process (Gelb 1974, section 3.8).
void LandmarkFilter::predict(const Twist& seen_in_camera, const Matrix6d& covariance, double dt_s) {
  using Matrix12d = Eigen::Matrix<double, kLandmarks, kLandmarks>;
  const RigidTransform before = state_.camera;
  const Twist twist = Twist::from_vector(seen_in_camera.vector() - state_.twist_bias);
  state_.camera = integrate_twist(before, twist, dt_s);
  state_.camera.rotation.normalize();
  const double fade = std::exp(-dt_s / config_.bias_correlation_s);
  state_.twist_bias *= fade;

  const Eigen::Matrix3d R_dt = before.rotation.toRotationMatrix() * dt_s;
  Matrix6d by_twist = Matrix6d::Zero();
  by_twist.topLeftCorner<3, 3>() = by_twist.bottomRightCorner<3, 3>() = -R_dt;
  Matrix12d F = Matrix12d::Identity();
  F.block<3, 3>(kPosition, kRotation) = -skew(state_.camera.translation - before.translation);
  F.block<6, 6>(kPosition, kBias) = by_twist;
  F.block<6, 6>(kBias, kBias) *= fade;
  Matrix12d Q = Matrix12d::Zero();
  Q.block<6, 6>(kPosition, kPosition) = by_twist * covariance * by_twist.transpose();
  const double fresh = 1 - square(fade);
  Q.diagonal().segment<3>(kBias).setConstant(fresh * square(config_.velocity_bias_sigma_m_s));
  Q.diagonal().segment<3>(kBias + 3).setConstant(fresh * square(config_.rate_bias_sigma_rad_s));

  const Matrix12d P = F * P_.topLeftCorner<kLandmarks, kLandmarks>() * F.transpose() + Q;
  P_.topLeftCorner<kLandmarks, kLandmarks>() = 0.5 * (P + P.transpose());
  const int rest = size() - kLandmarks;
  const Eigen::MatrixXd with_landmarks = F * P_.block(0, kLandmarks, kLandmarks, rest);
  P_.block(0, kLandmarks, kLandmarks, rest) = with_landmarks;
  P_.block(kLandmarks, 0, rest, kLandmarks) = with_landmarks.transpose();
}

// Y = R^T (l - p), h = (Y_x, Y_y) / Y_z: landmark_model.hpp with both places in the world.
std::optional<Innovation<2>> LandmarkFilter::innovation(const State& at,
                                                        const LandmarkSighting& seen) const {
  constexpr double kNearest_m = 0.05;
  const Entry& of = entry(seen.landmark);
  const bool is_member = of.slot >= 0;
  const Eigen::Matrix3d R_t = at.camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d u =
      (is_member ? at.landmarks[static_cast<std::size_t>(of.slot)] : of.known.position_in_world_m) -
      at.camera.translation;
  const Eigen::Vector3d Y = R_t * u;
  if (!(Y.z() > kNearest_m)) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> J = bearing_by_direction(R_t, Y);
  Innovation<2> out{.residual = seen.bearing - Y.hnormalized(), .H = {}, .noise = seen.covariance};
  out.H.add(kPosition, -J);
  out.H.add(kRotation, J * skew(u));
  if (is_member) out.H.add(kLandmarks + 3 * of.slot, J);
  return out;
}

void LandmarkFilter::admit(int number) {
  if (landmarks() == config_.most_landmarks) make_room();
  Entry& fresh = entry(number);
  const int column = size();
  fresh.slot = landmarks();
  members_.push_back(number);
  state_.landmarks.push_back(fresh.known.position_in_world_m);
  P_.middleRows<3>(column).setZero();
  P_.middleCols<3>(column).setZero();
  P_.block<3, 3>(column, column) = fresh.known.covariance_m2;
}

// The landmark that was not seen for longest goes, the last one takes its place. It does not come
// back: its error is in the pose, by how much is no longer known.
void LandmarkFilter::make_room() {
  const auto oldest = std::ranges::min_element(
      members_, {}, [this](int number) { return entry(number).last_frame; });
  Entry& gone = entry(*oldest);
  const int to = kLandmarks + 3 * gone.slot;
  const int from = size() - 3;
  P_.middleRows<3>(to) = P_.middleRows<3>(from).eval();
  P_.middleCols<3>(to) = P_.middleCols<3>(from).eval();
  state_.landmarks[static_cast<std::size_t>(gone.slot)] = state_.landmarks.back();
  entry(members_.back()).slot = gone.slot;
  *oldest = members_.back();
  gone.slot = -1;
  gone.is_spent = true;
  members_.pop_back();
  state_.landmarks.pop_back();
}

LandmarkFilter::Joint LandmarkFilter::joint(const std::vector<Innovation<2>>& innovations) const {
  const int n = size();
  const auto rows = 2 * static_cast<Eigen::Index>(innovations.size());
  Joint out{.PHt = Eigen::MatrixXd(n, rows),
            .S = Eigen::MatrixXd(rows, rows),
            .residual = Eigen::VectorXd(rows)};
  Eigen::Index row = 0;
  for (const Innovation<2>& one : innovations) {
    out.PHt.middleCols<2>(row) = one.H.times_transposed(P_, n);
    out.residual.segment<2>(row) = one.residual;
    row += 2;
  }
  row = 0;
  for (const Innovation<2>& one : innovations) {
    out.S.middleRows<2>(row) = one.H.times(out.PHt);
    out.S.block<2, 2>(row, row) += one.noise;
    row += 2;
  }
  return out;
}

LandmarkFilter::State LandmarkFilter::moved(const Eigen::VectorXd& error) const {
  State out = state_;
  out.camera.translation += error.segment<3>(kPosition);
  out.camera.rotation = (so3_exp(error.segment<3>(kRotation)) * out.camera.rotation).normalized();
  out.twist_bias += error.segment<6>(kBias);
  Eigen::Index column = kLandmarks;
  for (Eigen::Vector3d& landmark : out.landmarks) {
    landmark += error.segment<3>(column);
    column += 3;
  }
  return out;
}

// Iterated (Bell, Cathey 1993): x <- x_0 + K (z - h(x) + H (x - x_0)) until no bearing moves.
bool LandmarkFilter::correct(const std::vector<LandmarkSighting>& sightings) {
  constexpr int kMostSteps = 5;
  constexpr double kSettled = 1e-3;
  Eigen::VectorXd error = Eigen::VectorXd::Zero(size());
  Eigen::MatrixXd A_t;
  double step = HUGE_VAL;
  for (int k = 0; k < kMostSteps && step > kSettled; ++k) {
    const State at = moved(error);
    std::vector<Innovation<2>> innovations;
    innovations.reserve(sightings.size());
    for (const LandmarkSighting& seen : sightings) {
      std::optional<Innovation<2>> one = innovation(at, seen);
      if (!one) return false;
      one->residual += one->H.times(error);
      innovations.push_back(*one);
    }
    const Joint all = joint(innovations);
    const Eigen::LLT<Eigen::MatrixXd> factor(all.S);
    if (factor.info() != Eigen::Success) return false;
    A_t = factor.matrixL().solve(all.PHt.transpose());
    const Eigen::VectorXd next = A_t.transpose() * factor.matrixL().solve(all.residual);
    const Eigen::VectorXd change = next - error;
    step = 0;
    for (const Innovation<2>& one : innovations) {
      step = std::max(step, one.H.times(change).norm());
    }
    error = next;
  }
  if (!error.allFinite()) return false;
  // K S K^T = A A^T with A = P H^T L^-T: what is taken off P is symmetric to the last bit
  P_.topLeftCorner(size(), size()).noalias() -= A_t.transpose() * A_t;
  state_ = moved(error);
  return true;
}

// A landmark's first sighting may be a false one, hidden by the map's error. It counts from the
// second on that is off by the same: what is false seldom repeats itself.
SightingVerdict LandmarkFilter::take(const LandmarkSighting& seen) {
  const bool is_finite = seen.bearing.allFinite() && seen.covariance.allFinite();
  if (!is_finite || seen.landmark < 0 || seen.landmark >= std::ssize(map_)) {
    return SightingVerdict::refused;
  }
  Entry& of = entry(seen.landmark);
  if (of.is_spent) return SightingVerdict::refused;
  of.last_frame = frame_;
  if (of.slot >= 0) return SightingVerdict::used;
  const std::optional<Innovation<2>> now = innovation(state_, seen);
  if (!now || !of.awaiting ||
      !is_within_sigmas(now->residual - of.awaiting->residual, now->noise + of.awaiting->noise,
                        config_.gate_sigma)) {
    return SightingVerdict::awaiting;
  }
  admit(seen.landmark);
  return SightingVerdict::used;
}

std::vector<SightingVerdict> LandmarkFilter::update(std::span<const LandmarkSighting> sightings) {
  ++frame_;
  std::vector<SightingVerdict> verdicts;
  verdicts.reserve(sightings.size());
  for (const LandmarkSighting& seen : sightings) verdicts.push_back(take(seen));

  std::vector<std::size_t> candidates;
  std::vector<Innovation<2>> innovations;
  candidates.reserve(sightings.size());
  innovations.reserve(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (verdicts[i] != SightingVerdict::used) continue;
    verdicts[i] = SightingVerdict::refused;
    const std::optional<Innovation<2>> one = innovation(state_, sightings[i]);
    if (!one || entry(sightings[i].landmark).slot < 0) continue;
    candidates.push_back(i);
    innovations.push_back(*one);
  }
  const Joint all = joint(innovations);
  const std::vector<bool> agree = largest_consensus(all.residual, all.S, config_.gate_sigma);
  std::vector<LandmarkSighting> used;
  used.reserve(candidates.size());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (agree[k]) used.push_back(sightings[candidates[k]]);
  }
  const bool is_corrected = !used.empty() && correct(used);
  for (std::size_t k = 0; k < candidates.size() && is_corrected; ++k) {
    if (agree[k]) verdicts[candidates[k]] = SightingVerdict::used;
  }
  // from the corrected pose the next frame's prediction will differ by dead reckoning only
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (verdicts[i] != SightingVerdict::awaiting) continue;
    entry(sightings[i].landmark).awaiting = innovation(state_, sightings[i]);
  }
  return verdicts;
}

KnownLandmark LandmarkFilter::landmark(int number) const {
  const Entry& of = map_.at(static_cast<std::size_t>(number));
  if (of.slot < 0) return of.known;
  const int column = kLandmarks + 3 * of.slot;
  return {state_.landmarks[static_cast<std::size_t>(of.slot)], P_.block<3, 3>(column, column)};
}

}  // namespace stillkite
