#include "estimation/sliding_window/window_tracks.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/triangulation.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

WindowObservation observation_of(const FeatureObservation& feature, std::int64_t frame_id) {
  return {.frame_id = frame_id,
          .bearing = feature.bearing,
          .information = feature.covariance.llt().solve(Eigen::Matrix2d::Identity())};
}

WindowTrack* find_track(Window& window, std::int64_t id) {
  const auto track =
      std::lower_bound(window.tracks.begin(), window.tracks.end(), id,
                       [](const WindowTrack& t, std::int64_t i) { return t.id < i; });
  return track == window.tracks.end() || track->id != id ? nullptr : &*track;
}

}  // namespace

void add_observations(Window& window, std::span<const FeatureObservation> features) {
  const std::int64_t newest = window.frames.back().id;
  for (const FeatureObservation& feature : features) {
    WindowTrack* track = find_track(window, feature.track_id);
    if (track != nullptr) track->observations.push_back(observation_of(feature, newest));
  }
}

void replace_observations(Window& window, std::span<const FeatureObservation> features) {
  const std::int64_t newest = window.frames.back().id;
  for (const FeatureObservation& feature : features) {
    WindowTrack* track = find_track(window, feature.track_id);
    if (track == nullptr) continue;
    if (track->in(newest) != nullptr) track->observations.pop_back();
    track->observations.push_back(observation_of(feature, newest));
  }
}

std::vector<ExpectedFeature> expected_features(const Window& window, std::int64_t keyframe_id) {
  std::vector<ExpectedFeature> expected;
  const auto keyframe = window.find(keyframe_id);
  if (!keyframe) return expected;
  const CameraPair pair = CameraPairs(window, false).at(*keyframe, window.frames.size() - 1);
  for (const WindowTrack& track : window.tracks) {
    if (!track.point || track.observations.front().frame_id != keyframe_id) continue;
    const auto bearing = project_bearing(pair, *track.point);
    if (bearing) expected.push_back({track.id, *bearing});
  }
  return expected;
}

void begin_tracks(Window& window, std::span<const FeatureObservation> features) {
  const std::int64_t newest = window.frames.back().id;
  for (const FeatureObservation& feature : features) {
    if (!window.tracks.empty() && feature.track_id <= window.tracks.back().id) continue;
    window.tracks.push_back({.id = feature.track_id,
                             .observations = {observation_of(feature, newest)},
                             .point = std::nullopt});
  }
}

void triangulate_tracks(Window& window) {
  for (WindowTrack& track : window.tracks) {
    if (!track.point) track.point = triangulate(window, track);
  }
}

MeasuredPoints reject_outliers(Window& window) {
  constexpr double kMaxSquaredError = 16;  // four sigma in two dimensions
  constexpr double kMinInverseDepth_1_m = 1e-6;
  const std::int64_t newest = window.frames.back().id;
  MeasuredPoints points;
  double squared_sum = 0;
  ReprojectionErrors errors(window);
  for (WindowTrack& track : window.tracks) {
    if (!track.point) continue;
    const auto is_outlier = [&](const WindowObservation& observation) {
      return &observation != track.observations.data() &&
             errors.squared(track, observation) > kMaxSquaredError;
    };
    points.measured += track.in(newest) != nullptr;
    std::vector<WindowObservation> kept;
    kept.reserve(track.observations.size());
    for (const WindowObservation& observation : track.observations) {
      if (!is_outlier(observation)) kept.push_back(observation);
    }
    track.observations = std::move(kept);
    if (const WindowObservation* inlier = track.in(newest)) {
      ++points.inliers;
      if (const auto residual = errors.residual(track, *inlier)) {
        squared_sum += residual->squaredNorm();
      }
    }
    if (track.point->inverse_depth < kMinInverseDepth_1_m) track.point.reset();
  }
  if (points.inliers > 0) points.residual = std::sqrt(squared_sum / (2 * points.inliers));
  return points;
}

void restart_tracks(Window& window) {
  const auto is_keyframe = [&](const WindowObservation& observation) {
    const auto at = window.find(observation.frame_id);
    return at && window.frames[*at].is_keyframe;
  };
  for (WindowTrack& track : window.tracks) {
    const auto first =
        std::find_if(track.observations.begin(), track.observations.end(), is_keyframe);
    if (first != track.observations.begin()) track.point.reset();
    track.observations.erase(track.observations.begin(), first);
  }
}

void remove_empty_tracks(Window& window) {
  const std::int64_t newest = window.frames.back().id;
  std::erase_if(window.tracks, [&](const WindowTrack& track) {
    if (track.observations.empty()) return true;
    return !track.point && track.observations.back().frame_id != newest;
  });
}

std::optional<double> median_depth_m(const Window& window) {
  std::vector<double> depths_m;
  for (const WindowTrack& track : window.tracks) {
    if (track.point) depths_m.push_back(1 / track.point->inverse_depth);
  }
  if (depths_m.empty()) return std::nullopt;
  return upper_median(depths_m);
}

}  // namespace stillkite
