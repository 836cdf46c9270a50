#include "live/page/page_address.hpp"

#include <algorithm>
#include <asio/ip/address.hpp>
#include <charconv>
#include <string_view>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

bool is_ipv6(const std::string& text) {
  return text.find(':') != std::string::npos;
}

}  // namespace

bool is_ip_address(const std::string& text) {
  asio::error_code error;
  static_cast<void>(asio::ip::make_address(text, error));
  return !error;
}

PageAddress parse_page_address(const std::string& text) {
  const std::size_t colon = std::min(text.rfind(':'), text.size());
  PageAddress out{.host = text.substr(0, colon)};
  const bool is_in_brackets = out.host.starts_with('[') && out.host.ends_with(']');
  if (is_in_brackets) out.host = out.host.substr(1, out.host.size() - 2);
  const bool is_host =
      (out.host == "localhost" || is_ip_address(out.host)) && is_ipv6(out.host) == is_in_brackets;
  const std::string_view number = std::string_view(text).substr(std::min(colon + 1, text.size()));
  const auto result = std::from_chars(number.data(), number.data() + number.size(), out.port);
  if (!is_host || result.ec != std::errc() || result.ptr != number.data() + number.size()) {
    throw InputError("live.listen: " + text +
                     " is no address; expected HOST:PORT with an IP address or localhost, for "
                     "example 127.0.0.1:8080");
  }
  out.is_loopback = out.host == "localhost" || out.host == "::1" || out.host.starts_with("127.");
  return out;
}

}  // namespace stillkite
