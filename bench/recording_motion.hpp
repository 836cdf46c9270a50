#pragma once

#include "recording.hpp"

namespace stillkite::bench {

/// Every n-th image, from the first. True velocities are averaged over the longer intervals.
[[nodiscard]] Recording every_nth_image(const Recording& recording, int n);

/// Backwards in time: t' = t_first + t_last - t. Poses are kept, velocities and angular rates
/// change sign, specific forces are kept. Images are rotated by 180 degrees about the optical axis,
/// because a rolling shutter would expose from the last row to the first; lens and mount follow.
[[nodiscard]] Recording backwards(const Recording& recording);

/// Mirrored world: M = diag(1, -1, 1) in world and body, S = diag(-1, 1, 1) in the camera.
/// R' = M R M, p' = M p for world_from_body; body_from_camera' = M R S, M p. Velocities and
/// specific forces are vectors, angular rates axial: w' = det(S) S w.
[[nodiscard]] Recording mirrored(const Recording& recording);

/// World translated along x and y so that the first image is at x = y = 0, where a run without
/// initial.from_truth begins.
[[nodiscard]] Recording from_origin(const Recording& recording);

/// World rotated by 90 degrees about z: a truth whose attitudes are all the identity is read as one
/// of positions alone.
[[nodiscard]] Recording with_rotated_world(const Recording& recording);

}  // namespace stillkite::bench
