#pragma once

#include <cstdint>
#include <string>

namespace stillkite {

/// Address of a link: UDP peer, UDP port to listen on (empty host), or serial device.
struct LinkAddress {
  enum class Kind { udp, serial };
  Kind kind = Kind::udp;
  std::string host;  ///< or device
  std::uint16_t port = 0;
  unsigned baud = 0;
};

/// Parses udp://HOST:PORT, udp://:PORT and serial:DEVICE:BAUD. Throws InputError that names `key`.
[[nodiscard]] LinkAddress parse_link_address(const std::string& text, const std::string& key);

}  // namespace stillkite
