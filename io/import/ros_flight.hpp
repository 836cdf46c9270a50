#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "io/import/imported_flight.hpp"
#include "io/import/ros_message.hpp"
#include "io/recording_format.hpp"

namespace stillkite {

/// Reads the messages of a ROS recording in MCAP, as a ROS 1 bag or in sqlite3. Returns the number
/// of damaged parts.
std::size_t read_ros_messages(const std::filesystem::path& file, RecordingFormat format,
                              const TakeRosMessage& take);

/// Sensors of a ROS recording; of each type the first topic. Clock: the headers' stamps.
///
/// | message | fields | unit, frame |
/// |---|---|---|
/// | sensor_msgs/Imu | angular_velocity, linear_acceleration, orientation | rad/s, m/s^2; x
/// forward, y left, z up (REP 103) | | sensor_msgs/NavSatFix with a fix | latitude, longitude,
/// altitude | deg, m | | sensor_msgs/Range | range | m, along the body's -z | |
/// sensor_msgs/CameraInfo | K, D | px | | sensor_msgs/Image, CompressedImage | first stamp and
/// number | |
struct RosFlight {
  ImportedFlight flight;
  std::optional<std::string> image_topic;
};

/// Throws InputError if the file cannot be opened.
[[nodiscard]] RosFlight read_ros_flight(const std::filesystem::path& file, RecordingFormat format);

/// Writes the images of a topic as an EuRoC camera: data.csv and data/STAMP.png, or .jpg as
/// recorded. Images of other encodings and with stamps out of order are left out. Returns the
/// number of images written. Throws std::runtime_error if a file cannot be written.
std::size_t write_ros_images(const std::filesystem::path& file, RecordingFormat format,
                             const std::string& topic, const std::filesystem::path& camera_folder);

}  // namespace stillkite
