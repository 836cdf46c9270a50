#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "io/import/gopro_stream.hpp"
#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Orientation of camera and image, one per frame. Axes: x right, y down, z forward.
struct GoproOrientation {
  std::vector<Timestamp> stamps;
  std::vector<Eigen::Quaterniond> camera_from_start;  ///< CORI
  std::vector<Eigen::Quaterniond> image_from_camera;  ///< IORI; empty: not recorded
  std::vector<Eigen::Vector3d> gravity_in_camera;     ///< GRAV, unit vectors

  [[nodiscard]] bool empty() const { return stamps.empty(); }
};

/// From the streams CORI, IORI and GRAV; empty unless CORI and GRAV have as many samples.
[[nodiscard]] GoproOrientation gopro_orientation(const GoproStream& camera,
                                                 const GoproStream& image,
                                                 const GoproStream& gravity,
                                                 std::optional<Timestamp> origin);

/// Largest rotation of the image against the camera: electronic stabilization.
[[nodiscard]] double max_image_rotation_rad(const GoproOrientation& orientation);

/// Clock offset: t_frame = t_imu + offset, at which the angular rates (body axes) agree best with
/// the orientations; nullopt if the camera hardly rotates. Within +-60 ms, in steps of 1 ms.
[[nodiscard]] std::optional<double> imu_clock_offset_s(
    const GoproOrientation& orientation, const TimeSeries<Eigen::Vector3d>& rate_in_body_rad_s);

/// Attitude world_from_body: vertical by GRAV, yaw by CORI, 0 at the start. With `of_image` the
/// body rotates as the image.
[[nodiscard]] TimeSeries<Eigen::Quaterniond> gopro_attitude(const GoproOrientation& orientation,
                                                            bool of_image);

/// Replaces the IMU by that of a body that rotates as the stabilized image: mean angular rates of
/// the frame intervals, and the mean specific force, rotated.
void rotate_imu_with_image(const GoproOrientation& orientation, ImportedFlight& flight);

}  // namespace stillkite
