#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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
/// (blank; t s, x y z, qx qy qz qw), detected by the separator. Throws InputError "file:line: ..."
/// on other formats, quaternions that are not of unit norm, and an empty table.
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

/// velocity.csv: t ns, v in m/s, w in rad/s, both in the camera frame. A row holds the motion at
/// the midpoint between the previous frame and its stamp.
[[nodiscard]] std::vector<StampedTwist> read_twists(const std::filesystem::path& file);

/// Line of a TUM file, newline included: t tx ty tz qx qy qz qw.
[[nodiscard]] std::string tum_line(const StampedPose& pose);

/// Header line of a TUM file, newline included.
inline constexpr const char* kTumHeader = "# timestamp_s tx ty tz qx qy qz qw (world_from_body)\n";

}  // namespace stillkite
