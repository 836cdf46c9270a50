#pragma once

#include <string>

namespace stillkite {

enum class StreamKind { standard_input, device, rtsp, rtp, udp, sdp };

/// Address of a live video source.
struct StreamAddress {
  StreamKind kind = StreamKind::udp;
  std::string url;   ///< of libavformat; path of a device or file
  std::string name;  ///< for messages: without user, password and query
};

/// The path without user and password, unless those are environment variables.
[[nodiscard]] std::string without_password(const std::string& path);

/// Throws InputError if the text is no address of a live source.
[[nodiscard]] StreamAddress parse_stream_address(const std::string& path);

}  // namespace stillkite
