#include "estimation/sliding_window/frame_selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "estimation/sliding_window/reprojection_errors.hpp"

namespace stillkite {

std::optional<std::size_t> closest_frame(const Window& window) {
  std::optional<std::size_t> closest;
  double shortest_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i + 1 < window.frames.size(); ++i) {
    if (window.frames[i].is_keyframe) continue;
    const double span_s = seconds_between(window.frames[i - 1].stamp, window.frames[i + 1].stamp);
    if (span_s >= shortest_s) continue;
    shortest_s = span_s;
    closest = i;
  }
  return closest;
}

namespace {

// Keyframe with a pose only whose observations have the most information on the inverse depths of
// the reference keyframe's points.
std::optional<std::int64_t> reference_partner(const Window& window) {
  const auto reference = window.find(window.reference_id);
  if (!reference) return std::nullopt;
  std::optional<std::int64_t> best;
  double most = 0;
  CameraPairs pairs(window, false);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    if (window.frames[i].has_motion || i == *reference) continue;
    double information = 0;
    for (const WindowTrack& track : window.tracks) {
      if (!track.point || track.observations.front().frame_id != window.reference_id) continue;
      const WindowObservation* observation = track.in(window.frames[i].id);
      if (observation == nullptr) continue;
      information += inverse_depth_information(pairs.at(*reference, i), *track.point, *observation);
    }
    if (information <= most) continue;
    most = information;
    best = window.frames[i].id;
  }
  return best;
}

// The present one, or that before as long as the present one is of the chain.
bool is_ground_keyframe(const Window& window, std::int64_t id) {
  if (id == window.ground_keyframe_id) return true;
  return std::ranges::any_of(window.alignments, [&](const GroundAlignment& alignment) {
    return alignment.is_link && alignment.keyframe_id == id &&
           window.frames[*window.find(alignment.frame_id)].has_motion;
  });
}

}  // namespace

std::size_t redundant_keyframe(const Window& window) {
  const WindowFrame& newest = window.frames.back();
  const std::optional<std::int64_t> partner = reference_partner(window);
  std::vector<std::size_t> poses, candidates;
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    if (window.frames[i].has_motion) continue;
    poses.push_back(i);
    const std::int64_t id = window.frames[i].id;
    if (id != window.reference_id && id != partner && !is_ground_keyframe(window, id)) {
      candidates.push_back(i);
    }
  }
  constexpr double kMinVisible_ratio = 0.05;
  for (const std::size_t i : candidates) {
    int hosted = 0;
    int visible = 0;
    for (const WindowTrack& track : window.tracks) {
      if (track.observations.empty() ||
          track.observations.front().frame_id != window.frames[i].id) {
        continue;
      }
      ++hosted;
      visible += track.in(newest.id) != nullptr;
    }
    if (visible <= kMinVisible_ratio * hosted) return i;
  }
  const auto distance = [&](std::size_t a, std::size_t b) {
    constexpr double kMin_m = 1e-3;
    return kMin_m + (window.frames[a].state.world_from_imu.translation -
                     window.frames[b].state.world_from_imu.translation)
                        .norm();
  };
  std::size_t redundant = candidates.front();
  double highest = 0;
  for (const std::size_t i : candidates) {
    double closeness = 0;
    for (const std::size_t k : poses) {
      if (k != i) closeness += 1 / distance(i, k);
    }
    const double score = std::sqrt(distance(i, window.frames.size() - 1)) * closeness;
    if (score <= highest) continue;
    highest = score;
    redundant = i;
  }
  return redundant;
}

}  // namespace stillkite
