#include "estimation/fusion/start_bundle.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "estimation/fusion/dense_update.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

constexpr Eigen::Index kPoint = 3;

Eigen::Index point_at(std::size_t i) {
  return kPoint * static_cast<Eigen::Index>(i);
}

RigidTransform moved(const RigidTransform& pose, const Vector6d& error) {
  return {(so3_exp(error.head<3>()) * pose.rotation).normalized(),
          pose.translation + error.tail<3>()};
}

template <typename Matrix>
double log_determinant(const Eigen::LLT<Matrix>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

// With V = L L^T of a point's normal equations, g their right side, X what they share with the
// poses: A = L^-1 X^T, a = L^-1 g, and the poses' are information - A^T A and pull - A^T a.
struct StartBundle::Equations {
  Eigen::MatrixXd information;
  Eigen::VectorXd pull;
  Eigen::MatrixXd A;
  Eigen::VectorXd a;
  std::vector<Eigen::Matrix3d> L;
  double squared = 0;  // of all residuals, in their sigmas, before the step
  double log_determinant = 0;
};

StartBundle::StartBundle(const FusionConfig& config, StartPrior prior, std::size_t anchor,
                         std::span<const ToldFrame> frames, const std::vector<std::size_t>& chosen,
                         std::vector<StartCandidate> candidates)
    : config_(config),
      prior_(std::move(prior)),
      world_from_anchor_(prior_.world_from_camera[anchor]),
      chosen_(chosen),
      candidates_(std::move(candidates)),
      views_(candidates_.size()) {
  constexpr double kExact = 1e-14;     // where the prior knows a pose exactly
  constexpr double kRounding = 1e-12;  // of variances that are differences of large ones
  const Eigen::Index size = pose_at(chosen.size());
  Eigen::MatrixXd covariance(size, size);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    covariance.middleRows<kPose>(pose_at(i)) =
        prior_.covariance.middleRows<kPose>(pose_at(chosen[i]));
  }
  covariance.diagonal() *= 1 + kRounding;
  covariance.diagonal().array() += kExact;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  is_prior_sound_ = factor.info() == Eigen::Success;
  prior_root_ = factor.matrixL();
  std::map<int, std::size_t> candidate_of;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    candidate_of[candidates_[i].reference.feature] = i;
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (const FeatureView& view : frames[chosen[i]].seen) {
      const auto candidate = candidate_of.find(view.feature);
      if (candidate == candidate_of.end()) continue;
      views_[candidate->second].push_back({i, view.bearing, view.covariance});
    }
  }
}

StartEstimate StartBundle::begin(const std::vector<double>& inverse_depths) const {
  StartEstimate estimate;
  estimate.points.reserve(candidates_.size());
  for (std::size_t i = 0; i < inverse_depths.size(); ++i) {
    estimate.points.push_back(
        {.bearing = candidates_[i].reference.bearing, .inverse_depth = inverse_depths[i]});
  }
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    estimate.world_from_camera.push_back(resected(i, estimate.points));
  }
  return estimate;
}

// By least squares from where the prior has it.
RigidTransform StartBundle::resected(std::size_t frame,
                                     const std::vector<StartEstimate::Point>& points) const {
  constexpr int kSteps = 5;
  constexpr int kFewest = 6;
  const RigidTransform& prior = prior_.world_from_camera[chosen_[frame]];
  RigidTransform pose = prior;
  for (int step = 0; step < kSteps; ++step) {
    Matrix6d N = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    int count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto view = std::find_if(views_[i].begin(), views_[i].end(),
                                     [&](const View& v) { return v.frame == frame; });
      if (view == views_[i].end()) continue;
      const auto seen =
          project_landmark(pose, world_from_anchor_, points[i].bearing, points[i].inverse_depth);
      if (!seen) continue;
      const Eigen::Matrix<double, 2, 6> weighted = view->covariance.llt().solve(seen->by_pose);
      N += seen->by_pose.transpose() * weighted;
      b += weighted.transpose() * (view->bearing - seen->bearing);
      ++count;
    }
    const Vector6d error = N.ldlt().solve(b);
    if (count < kFewest || !error.allFinite()) return prior;
    pose = moved(pose, error);
  }
  return pose;
}

Eigen::Matrix2d StartBundle::usual_covariance(const View& view, const StartEstimate& estimate,
                                              std::size_t point) const {
  const Eigen::Vector3d way =
      estimate.world_from_camera[view.frame].translation - world_from_anchor_.translation;
  return window_growth(config_, estimate.points[point].inverse_depth * way) * view.covariance;
}

Eigen::VectorXd StartBundle::prior_error(const StartEstimate& estimate) const {
  Eigen::VectorXd error(pose_at(chosen_.size()));
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const RigidTransform& prior = prior_.world_from_camera[chosen_[i]];
    const RigidTransform& pose = estimate.world_from_camera[i];
    error.segment<kPose>(pose_at(i)) << so3_log(prior.rotation * pose.rotation.conjugate()),
        prior.translation - pose.translation;
  }
  return error;
}

StartBundle::Equations StartBundle::equations(const StartEstimate& estimate) const {
  const std::size_t count = estimate.points.size();
  const Eigen::Index poses = pose_at(chosen_.size());
  Equations out{.information = Eigen::MatrixXd::Zero(poses, poses),
                .pull = Eigen::VectorXd::Zero(poses),
                .A = Eigen::MatrixXd::Zero(point_at(count), poses),
                .a = Eigen::VectorXd(point_at(count)),
                .L = std::vector<Eigen::Matrix3d>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const StartEstimate::Point& point = estimate.points[i];
    const StartCandidate& candidate = candidates_[i];
    Eigen::Matrix3d prior = Eigen::Matrix3d::Zero();
    prior.topLeftCorner<2, 2>() = candidate.reference.covariance;
    prior(2, 2) = square(estimate.vagueness * config_.inverse_depth_sigma_ratio * candidate.guess);
    const Eigen::LLT<Eigen::Matrix3d> prior_factor(prior);
    Eigen::Vector3d from_prior;
    from_prior << candidate.reference.bearing - point.bearing,
        candidate.guess - point.inverse_depth;
    Eigen::Matrix3d V = prior_factor.solve(Eigen::Matrix3d::Identity());
    Eigen::Vector3d g = V * from_prior;
    out.squared += from_prior.dot(g);
    out.log_determinant += log_determinant(prior_factor);
    auto X_t = out.A.middleRows<kPoint>(point_at(i));
    const double growth = stray_growth(config_, point.stray);
    for (const View& view : views_[i]) {
      const auto seen = project_landmark(estimate.world_from_camera[view.frame], world_from_anchor_,
                                         point.bearing, point.inverse_depth);
      if (!seen) {
        out.squared = HUGE_VAL;
        return out;
      }
      const Eigen::LLT<Eigen::Matrix2d> noise(growth * usual_covariance(view, estimate, i));
      const Eigen::Vector2d residual = view.bearing - seen->bearing;
      const Eigen::Matrix<double, 2, 6> by_pose = noise.solve(seen->by_pose);
      const Eigen::Matrix<double, 2, 3> by_point = noise.solve(seen->by_landmark);
      const Eigen::Index at = pose_at(view.frame);
      out.information.block<kPose, kPose>(at, at).noalias() += seen->by_pose.transpose() * by_pose;
      out.pull.segment<kPose>(at).noalias() += by_pose.transpose() * residual;
      X_t.middleCols<kPose>(at).noalias() += by_point.transpose() * seen->by_pose;
      V.noalias() += by_point.transpose() * seen->by_landmark;
      g.noalias() += by_point.transpose() * residual;
      out.squared += residual.dot(noise.solve(residual));
      out.log_determinant += log_determinant(noise);
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(V);
    out.log_determinant += log_determinant(factor);
    out.L[i] = factor.matrixL();
    factor.matrixL().solveInPlace(X_t);
    out.a.segment<kPoint>(point_at(i)) = factor.matrixL().solve(g);
  }
  subtract_gram(out.A, out.information);
  out.pull.noalias() -= out.A.transpose() * out.a;
  out.squared -= out.a.squaredNorm();
  return out;
}

// With P = L L^T the poses' prior covariance, e its mean's error, N and b their equations: the
// step e + L y, (1 + L^T N L) y = L^T (b - N e).
void StartBundle::step(StartEstimate& estimate) const {
  estimate.cost = HUGE_VAL;
  if (!is_prior_sound_) return;
  const Equations of = equations(estimate);
  if (!std::isfinite(of.squared)) return;
  const auto L = prior_root_.triangularView<Eigen::Lower>();
  const Eigen::VectorXd e = prior_error(estimate);
  const Eigen::MatrixXd NL = of.information * L;
  Eigen::MatrixXd M = L.transpose() * NL;
  M.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  const Eigen::VectorXd Ne = of.information * e;
  const Eigen::VectorXd right = L.transpose() * (of.pull - Ne);
  const Eigen::VectorXd y = factor.solve(right);
  const Eigen::VectorXd poses = e + L * y;
  const Eigen::VectorXd points = of.a - of.A * poses;
  if (factor.info() != Eigen::Success || !points.allFinite()) return;
  const double least = e.dot(Ne) - 2 * of.pull.dot(e) - right.dot(y);
  estimate.cost = of.squared + least + of.log_determinant + log_determinant(factor);
  estimate.step = of.a.squaredNorm() + L.solve(e).squaredNorm() - least;
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    RigidTransform& pose = estimate.world_from_camera[i];
    pose = moved(pose, poses.segment<kPose>(pose_at(i)));
  }
  for (std::size_t i = 0; i < estimate.points.size(); ++i) {
    const Eigen::Vector3d error = of.L[i].triangularView<Eigen::Lower>().transpose().solve(
        points.segment<kPoint>(point_at(i)));
    estimate.points[i].bearing += error.head<2>();
    estimate.points[i].inverse_depth += error.z();
  }
}

bool StartBundle::add_rest(StartEstimate& estimate) const {
  estimate.vagueness = kVagueness;
  if (estimate.points.size() == candidates_.size()) return false;
  for (std::size_t i = estimate.points.size(); i < candidates_.size(); ++i) {
    estimate.points.push_back(
        {.bearing = candidates_[i].reference.bearing, .inverse_depth = candidates_[i].guess});
  }
  return true;
}

void StartBundle::weigh(StartEstimate& estimate) const {
  struct Error {
    std::size_t point;
    double squared;
  };
  std::vector<std::vector<Error>> errors(chosen_.size());
  for (std::size_t i = 0; i < estimate.points.size(); ++i) {
    StartEstimate::Point& point = estimate.points[i];
    point.stray = {};
    point.views = 0;
    for (const View& view : views_[i]) {
      const auto seen = project_landmark(estimate.world_from_camera[view.frame], world_from_anchor_,
                                         point.bearing, point.inverse_depth);
      if (!seen) continue;
      const Eigen::Vector2d residual = view.bearing - seen->bearing;
      errors[view.frame].push_back(
          {i, residual.dot(usual_covariance(view, estimate, i).llt().solve(residual)) / 2});
    }
  }
  for (const std::vector<Error>& frame : errors) {
    std::vector<double> squared;
    squared.reserve(frame.size());
    for (const Error& error : frame) squared.push_back(error.squared);
    // what fits far better than is told is no stray
    constexpr double kLeast = 0.25;
    const double usual = std::max(kLeast, usual_error(std::move(squared)));
    for (const Error& error : frame) {
      StartEstimate::Point& point = estimate.points[error.point];
      point.stray.add(error.squared / usual);
      ++point.views;
    }
  }
}

std::vector<RigidTransform> StartBundle::way(const StartEstimate& estimate) const {
  const auto L = prior_root_.triangularView<Eigen::Lower>();
  const Eigen::VectorXd told = L.transpose().solve(L.solve(-prior_error(estimate)));
  const Eigen::VectorXd errors = prior_.covariance * told;
  std::vector<RigidTransform> way = prior_.world_from_camera;
  for (std::size_t i = 0; i < way.size(); ++i) {
    way[i] = moved(way[i], errors.segment<kPose>(pose_at(i)));
  }
  return way;
}

}  // namespace stillkite
