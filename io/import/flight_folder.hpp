#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/import/recording.hpp"

namespace stillkite {

/// Writes the flight as a new folder; files without a reading are left out:
///
/// | file | columns after the stamp [ns] | frame |
/// |---|---|---|
/// | cam0/data.csv | image of a ROS recording | |
/// | imu0/data.csv | wx wy wz [rad/s], ax ay az [m/s^2] | body |
/// | attitude.csv | qw qx qy qz | world_from_body |
/// | range.csv, height.csv | m | along the body's -z; barometric |
/// | gnss_positions.csv | x y z [m] | world: east, north, up of the origin in flight.yaml |
/// | gnss_velocity.csv | vx vy vz [m/s] | world |
/// | flight.yaml | configuration of stillkite run | |
///
/// Stamps are those of the recording. Returns the notes of the import, those of the readers first.
/// Throws InputError as OutputFolder.
std::vector<ImportNote> write_flight_folder(const Recording& recording,
                                            const ImportOptions& options,
                                            const std::filesystem::path& out);

}  // namespace stillkite
