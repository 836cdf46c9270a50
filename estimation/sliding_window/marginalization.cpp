#include "estimation/sliding_window/marginalization.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>
#include <vector>

#include "estimation/sliding_window/ground_points.hpp"
#include "estimation/sliding_window/window_solver.hpp"

namespace stillkite {
namespace {

// Indices below `size` outside [first, first + count).
std::vector<Eigen::Index> others(Eigen::Index size, Eigen::Index first, Eigen::Index count) {
  std::vector<Eigen::Index> kept;
  kept.reserve(static_cast<std::size_t>(size - count));
  for (Eigen::Index i = 0; i < size; ++i) {
    if (i < first || i >= first + count) kept.push_back(i);
  }
  return kept;
}

// Variables [first, first + count) leave: H_kk - H_km H_mm^-1 H_mk.
WindowEquations without(const WindowEquations& all, Eigen::Index first, Eigen::Index count) {
  constexpr double kMinRelativeEigenvalue = 1e-14;
  const std::vector<Eigen::Index> kept = others(all.gradient.size(), first, count);
  const Eigen::MatrixXd H_km = all.information(kept, Eigen::seqN(first, count));
  // scaled to a unit diagonal, because the units differ
  const Eigen::VectorXd scale =
      all.information.diagonal().segment(first, count).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      scale.asDiagonal() * all.information.block(first, first, count, count) * scale.asDiagonal());
  const double smallest = kMinRelativeEigenvalue * eigen.eigenvalues()(count - 1);
  const Eigen::VectorXd inverse =
      (eigen.eigenvalues().array() > smallest).select(eigen.eigenvalues().cwiseInverse(), 0);
  const Eigen::MatrixXd root =
      scale.asDiagonal() * eigen.eigenvectors() * inverse.cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd weighted = H_km * root;
  WindowEquations out{all.information(kept, kept), all.gradient(kept)};
  out.information.noalias() -= weighted * weighted.transpose();
  out.gradient.noalias() -= weighted * (root.transpose() * all.gradient.segment(first, count));
  return out;
}

// The prior about the first estimates; frames it newly depends on get theirs now.
void set_prior(Window& window, WindowEquations equations) {
  const std::vector<int> offsets = window.offsets();
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    const auto diagonal = equations.information.diagonal().segment(offsets[i], frame.size());
    if (!frame.first_estimate && (diagonal.array() > 0).any()) frame.first_estimate = frame.state;
  }
  const Eigen::VectorXd error = error_from_first_estimates(window);
  window.prior.gradient = equations.gradient + equations.information * error;
  window.prior.information = 0.5 * (equations.information + equations.information.transpose());
}

void remove_observations(Window& window, std::int64_t frame_id) {
  for (WindowTrack& track : window.tracks) {
    std::erase_if(track.observations,
                  [&](const WindowObservation& o) { return o.frame_id == frame_id; });
  }
}

bool is_of(const GroundAlignment& alignment, std::int64_t frame_id) {
  return alignment.keyframe_id == frame_id || alignment.frame_id == frame_id;
}

void remove_alignments(Window& window, std::int64_t frame_id) {
  std::erase_if(window.alignments,
                [&](const GroundAlignment& alignment) { return is_of(alignment, frame_id); });
}

// Removes a frame with its observations; the prior does not depend on it.
void remove_variables(Window& window, std::size_t frame) {
  const Eigen::Index first = window.offsets()[frame];
  const Eigen::Index count = window.frames[frame].size();
  remove_observations(window, window.frames[frame].id);
  remove_alignments(window, window.frames[frame].id);
  window.frames.erase(window.frames.begin() + static_cast<std::ptrdiff_t>(frame));
  MarginalPrior& prior = window.prior;
  const std::vector<Eigen::Index> kept = others(prior.gradient.size(), first, count);
  prior.information = prior.information(kept, kept).eval();
  prior.gradient = prior.gradient(kept).eval();
}

}  // namespace

void marginalize_motion(Window& window, std::size_t frame) {
  WindowScope scope;
  if (frame + 1 < window.frames.size()) scope.imu_frames.push_back(frame + 1);
  if (window.frames[frame].rest_sigma_m_s) scope.rest_frames.push_back(frame);
  WindowEquations equations = window_equations(window, scope);
  const int first = window.offsets()[frame] + InertialIndex::kPoseSize;
  equations = without(equations, first, InertialIndex::kSize - InertialIndex::kPoseSize);
  window.frames[frame].has_motion = false;
  set_prior(window, std::move(equations));
}

void marginalize_frame(Window& window, std::size_t frame) {
  const std::int64_t id = window.frames[frame].id;
  const std::int64_t newest = window.frames.back().id;
  WindowScope scope;
  scope.excluded_frame_id = newest;
  if (frame > 0 && window.frames[frame - 1].has_motion) scope.imu_frames.push_back(frame);
  if (frame + 1 < window.frames.size() && window.frames[frame].has_motion) {
    scope.imu_frames.push_back(frame + 1);
  }
  if (window.frames[frame].has_motion && window.frames[frame].rest_sigma_m_s) {
    scope.rest_frames.push_back(frame);
  }
  for (std::size_t i = 0; i < window.tracks.size(); ++i) {
    const WindowTrack& track = window.tracks[i];
    if (track.point && track.observations.front().frame_id == id) scope.tracks.push_back(i);
  }
  // the others have errors in common with alignments to come
  for (std::size_t i = 0; i < window.alignments.size(); ++i) {
    const GroundAlignment& alignment = window.alignments[i];
    if (alignment.is_link && is_of(alignment, id)) scope.alignments.push_back(i);
  }
  WindowEquations equations = window_equations(window, scope);
  equations = without(equations, window.offsets()[frame], window.frames[frame].size());
  keep_ground_points(window, scope.tracks);
  for (const std::size_t i : scope.tracks) {
    WindowTrack& track = window.tracks[i];
    track.point.reset();
    std::erase_if(track.observations,
                  [&](const WindowObservation& o) { return o.frame_id != newest; });
  }
  remove_observations(window, id);
  remove_alignments(window, id);
  // the chain is interrupted here: what its factors measured is in the prior
  if (frame + 1 < window.frames.size() && frame > 0 && window.frames[frame - 1].has_motion) {
    window.frames[frame + 1].imu = ImuPreintegration(window.frames[frame + 1].imu.noise());
  }
  window.frames.erase(window.frames.begin() + static_cast<std::ptrdiff_t>(frame));
  set_prior(window, std::move(equations));
}

void merge_frame(Window& window, std::size_t frame) {
  WindowFrame& next = window.frames[frame + 1];
  ImuPreintegration merged = window.frames[frame].imu;
  merged.append(next.imu);
  next.imu = std::move(merged);
  remove_variables(window, frame);
}

void remove_first_frame(Window& window) {
  remove_variables(window, 0);
}

}  // namespace stillkite
