#pragma once

#include <string>

namespace stillkite {

enum class StreamKind { standard_input, device, rtsp, rtp, udp, sdp };

/// Address of a live video source.
struct StreamAddress {
  StreamKind kind = StreamKind::udp;
  std::string url;   ///< of libavformat; path of a device or file
  std::string name;  ///< for messages: without user and password
};

/// Throws InputError if the text is no address of a live source.
[[nodiscard]] StreamAddress parse_stream_address(const std::string& path);

}  // namespace stillkite
