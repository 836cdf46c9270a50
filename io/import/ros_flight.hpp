#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
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

/// Sensors of a ROS recording; of each type the first topic. Clock: the headers' stamps, or, of
/// headers without, the time of recording. Messages, units and frames: docs/import.md.
struct RosFlight {
  ImportedFlight flight;
  std::optional<std::string> image_topic;
};

/// `poll` is called for each message and may throw to end the reading. Throws InputError if the
/// file cannot be opened.
[[nodiscard]] RosFlight read_ros_flight(const std::filesystem::path& file, RecordingFormat format,
                                        const std::function<void()>& poll);

/// Images written of a topic.
struct RosImages {
  std::size_t written = 0;
  std::size_t rejected = 0;         ///< not JPEG, PNG or a known encoding, damaged, or out of order
  std::string encoding;             ///< of the first rejected image
  int width_px = 0, height_px = 0;  ///< of the first written image
};

/// Writes the images of a topic as an EuRoC camera: data.csv and data/STAMP.png, or .jpg as
/// recorded. `poll` as above. Throws std::runtime_error if a file cannot be written.
RosImages write_ros_images(const std::filesystem::path& file, RecordingFormat format,
                           const std::string& topic, const std::filesystem::path& camera_folder,
                           const std::function<void()>& poll);

}  // namespace stillkite
