#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// The trajectory file that the path stands for: itself if it is a file; in a folder data.csv, a
/// EuRoC data set's mav0/state_groundtruth_estimate0/data.csv, or a run's trajectory.tum. Nothing
/// if the folder has none. Throws InputError if the path does not exist.
[[nodiscard]] std::optional<std::filesystem::path> find_trajectory(
    const std::filesystem::path& path);

/// Poses world_from_body with ascending stamps from EuRoC (comma; t ns, x y z, qw qx qy qz) or TUM
/// (blank; t s, x y z, qx qy qz qw), told apart by their separator. Throws InputError with
/// file:line on anything else, on quaternions that are not of unit length, and on an empty table.
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path);

/// velocity.csv: t ns, v in m/s, w in rad/s, both in the camera frame. The row of a stamp is the
/// motion half way between the frame before and that frame.
[[nodiscard]] std::vector<StampedTwist> read_twists(const std::filesystem::path& file);

/// One line of a TUM file, with its end of line: t tx ty tz qx qy qz qw.
[[nodiscard]] std::string tum_line(const StampedPose& pose);

/// A line of names as TUM files carry it.
inline constexpr const char* kTumHeader = "# timestamp_s tx ty tz qx qy qz qw (world_from_body)\n";

}  // namespace stillkite
