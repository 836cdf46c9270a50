#pragma once

#include <filesystem>

#include "io/import/ros_message.hpp"

namespace stillkite {

/// Reads the messages of a ROS 1 bag (wiki.ros.org/Bags/Format/2.0) from the beginning to the end;
/// chunks may be compressed by lz4 or bz2. Returns the number of damaged chunks, and 1 if the end
/// is cut off. Throws InputError if the file cannot be opened.
std::size_t read_rosbag(const std::filesystem::path& file, const TakeRosMessage& take);

/// Reads the messages of a ROS 2 bag in sqlite3, ordered by time. Returns 1 if the database is
/// damaged. Throws InputError if it is no ROS 2 bag.
std::size_t read_ros_database(const std::filesystem::path& file, const TakeRosMessage& take);

}  // namespace stillkite
