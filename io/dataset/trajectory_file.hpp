#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/stamped_velocity.hpp"
#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Trajectory file of a path: the file itself, or in a folder data.csv, the EuRoC data set's
/// mav0/state_groundtruth_estimate0/data.csv, or a run's trajectory.tum. Nullopt if the folder has
/// none. Throws InputError if the path does not exist or the folder has a truth and a
/// trajectory.tum.
[[nodiscard]] std::optional<std::filesystem::path> find_trajectory(
    const std::filesystem::path& path);

/// Poses world_from_body, stamps ascending, from EuRoC (comma; t ns, x y z, qw qx qy qz) or TUM
/// (blank; t s, x y z, qx qy qz qw), detected by the separator. Rows of four columns (t, x y z)
/// give poses with the identity as attitude. Throws InputError "file:line: ..." on other formats,
/// quaternions that are not of unit norm, and an empty table.
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

/// As read_trajectory, with the identity as attitude; columns after x y z are ignored.
[[nodiscard]] std::vector<StampedPose> read_positions(const std::filesystem::path& path);

/// False if two or more poses all have the identity as attitude, which stands for an unknown one in
/// trajectories of positions alone (GNSS, prism).
[[nodiscard]] bool has_attitude(std::span<const StampedPose> poses);

/// velocity.csv: t ns, v in m/s, w in rad/s, both in the camera frame. A row holds the motion at
/// the midpoint between the previous frame and its stamp.
[[nodiscard]] std::vector<StampedTwist> read_twists(const std::filesystem::path& file);

/// Velocities in the world: t ns, v in m/s.
[[nodiscard]] std::vector<StampedVelocity> read_velocities(const std::filesystem::path& file);

/// Number of columns of the first row; 0 without one.
[[nodiscard]] std::size_t count_columns(const std::filesystem::path& file);

/// Line of a TUM file, newline included: t tx ty tz qx qy qz qw.
[[nodiscard]] std::string tum_line(const StampedPose& pose);

/// Header line of a TUM file, newline included.
inline constexpr const char* kTumHeader = "# timestamp_s tx ty tz qx qy qz qw (world_from_body)\n";

}  // namespace stillkite
