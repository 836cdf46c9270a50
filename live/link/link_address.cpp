#include "live/link/link_address.hpp"

#include <charconv>
#include <limits>
#include <string_view>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// Number of the whole text, at most `max`; 0 if invalid.
unsigned number_of(std::string_view text, unsigned max) {
  unsigned value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_valid = result.ec == std::errc() && result.ptr == text.data() + text.size();
  return is_valid && value <= max ? value : 0;
}

}  // namespace

LinkAddress parse_link_address(const std::string& text, const std::string& key) {
  constexpr std::string_view kUdp = "udp://", kSerial = "serial:";
  const std::string_view whole = text;
  const std::size_t colon = whole.rfind(':');
  const std::string_view number =
      whole.substr(colon == std::string_view::npos ? whole.size() : colon + 1);
  LinkAddress out;
  if (whole.starts_with(kUdp) && colon >= kUdp.size()) {
    out.host = whole.substr(kUdp.size(), colon - kUdp.size());
    out.port =
        static_cast<std::uint16_t>(number_of(number, std::numeric_limits<std::uint16_t>::max()));
    if (out.port > 0) return out;
  } else if (whole.starts_with(kSerial) && colon > kSerial.size()) {
    out.kind = LinkAddress::Kind::serial;
    out.host = whole.substr(kSerial.size(), colon - kSerial.size());
    out.baud = number_of(number, 10'000'000);
    if (out.baud > 0) return out;
  }
  throw InputError(key + ": " + text +
                   " is no address; expected udp://HOST:PORT, udp://:PORT or serial:DEVICE:BAUD");
}

}  // namespace stillkite
