#pragma once

#include <cstdint>
#include <string>

namespace stillkite {

/// Address that the operator's page listens on.
struct PageAddress {
  std::string host;        ///< IPv4 or IPv6 address, or localhost
  std::uint16_t port = 0;  ///< 0: any free port
  bool is_loopback = true;
};

/// True for an IPv4 or IPv6 address without brackets.
[[nodiscard]] bool is_ip_address(const std::string& text);

/// Parses HOST:PORT; an IPv6 address is in brackets. Throws InputError that names live.listen.
[[nodiscard]] PageAddress parse_page_address(const std::string& text);

}  // namespace stillkite
