#pragma once

#include <filesystem>

#include "io/import/ros_message.hpp"

namespace stillkite {

/// Reads the ROS messages of an MCAP recording (mcap.dev/spec) from the beginning to the end, with
/// or without chunks and indices. Returns the number of damaged chunks, and 1 if the end is cut
/// off. Throws InputError if the file cannot be opened.
std::size_t read_mcap(const std::filesystem::path& file, const TakeRosMessage& take);

}  // namespace stillkite
