#include "estimation/sliding_window/ground_points.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/window_solver.hpp"

namespace stillkite {
namespace {

// Heights of points above the ground by images alone.
class PointHeights {
 public:
  explicit PointHeights(const Window& window)
      : window_(window), ground_(window, false), pairs_(window, false) {}

  // Empty for a point that has none, is above the horizon, or in the prior.
  std::optional<PointHeight> of(const WindowTrack& track) {
    if (!track.point || track.is_ground_marginalized) return std::nullopt;
    const std::size_t host = *window_.find(track.observations.front().frame_id);
    const GroundView& view = ground_.at(host);
    if (!point_on_ground(view, track.point->bearing)) return std::nullopt;
    double information = 0;
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const std::size_t target = *window_.find(track.observations[k].frame_id);
      information +=
          inverse_depth_information(pairs_.at(host, target), *track.point, track.observations[k]);
    }
    information /= view.height_m * view.height_m;  // of the height over the depth
    constexpr double kUnknownVariance = 1e6;
    const double variance = std::min(1 / information, kUnknownVariance);
    // without the ground's own pull
    const double ratio =
        view.height_ratio(*track.point) * (1 + track.ground_information * variance);
    const double depth_m = 1 / track.point->inverse_depth;
    return PointHeight{ratio * depth_m, variance * depth_m * depth_m};
  }

 private:
  const Window& window_;
  GroundViews ground_;
  CameraPairs pairs_;
};

double ground_information(const GroundRelief& relief, double probability,
                          const InverseDepthPoint& point) {
  const double sigma = relief.sigma_m() * point.inverse_depth;
  return probability / (sigma * sigma);
}

}  // namespace

std::size_t place_on_ground(Window& window) {
  if (!window.start) return 0;
  const GroundRelief& relief = window.start->relief;
  GroundViews ground(window, false);
  std::size_t placed = 0;
  for (WindowTrack& track : window.tracks) {
    if (track.point || track.is_ground_marginalized || track.observations.size() < 2) continue;
    const WindowObservation& host = track.observations.front();
    track.point = point_on_ground(ground.at(*window.find(host.frame_id)), host.bearing);
    if (!track.point) continue;
    track.ground_information = ground_information(relief, relief.share(), *track.point);
    ++placed;
  }
  return placed;
}

void update_ground_points(Window& window) {
  constexpr int kIterations = 3;
  constexpr double kMinProbability = 0.5;
  constexpr double kMaxSigma_ratio = 0.2;  // of a depth, as triangulated
  if (!window.start) return;
  GroundRelief& relief = window.start->relief;
  std::vector<std::pair<WindowTrack*, PointHeight>> points;
  PointHeights heights(window);
  for (WindowTrack& track : window.tracks) {
    const std::optional<PointHeight> height = heights.of(track);
    track.ground_information = 0;
    if (height) points.emplace_back(&track, *height);
  }
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    relief.begin_update();
    for (const auto& [track, height] : points) relief.add(height);
    relief.update();
  }
  for (const auto& [track, height] : points) {
    const double probability = relief.probability(height);
    track->ground_information = ground_information(relief, probability, *track->point);
    const double camera_height_m = window.start->world_from_imu.translation.z();
    const bool is_seen = std::sqrt(height.variance_m2) < kMaxSigma_ratio * camera_height_m;
    if (probability < kMinProbability && !is_seen) {
      track->point.reset();
      track->ground_information = 0;
    }
  }
}

void level_ground(Window& window) {
  constexpr double kMinRatio = 20;  // "strong" (Kass, Raftery 1995)
  if (!window.start || window.start->is_level || !window.start->level_slope_rad) return;
  const std::optional<Eigen::MatrixXd> covariance = window_covariance(window);
  if (!covariance) return;
  const auto slope = Eigen::seqN(SharedIndex::kGround + GroundIndex::kSlope, 2);
  const Eigen::Matrix2d P = (*covariance)(slope, slope);
  const double before = window.start->slope_sigma();
  if (*window.start->level_slope_rad >= before) return;
  const Eigen::Vector2d& s = window.ground.slope;
  const double ratio =
      before * before / std::sqrt(P.determinant()) * std::exp(-0.5 * s.dot(P.ldlt().solve(s)));
  if (!(ratio > kMinRatio)) return;
  window.start->is_level = true;
  const double after = window.start->slope_sigma();
  const double information = 1 / (after * after) - 1 / (before * before);
  window.prior.information.diagonal()(slope).array() += information;
  window.prior.gradient(slope) -= information * window.first_ground.slope;
}

void keep_ground_points(Window& window, const std::vector<std::size_t>& tracks) {
  if (!window.start) return;
  PointHeights heights(window);
  for (const std::size_t i : tracks) {
    WindowTrack& track = window.tracks[i];
    if (!(track.ground_information > 0)) continue;
    if (const auto height = heights.of(track)) window.start->relief.keep(*height);
    track.ground_information = 0;
    track.is_ground_marginalized = true;
  }
}

}  // namespace stillkite
