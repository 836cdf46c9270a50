#include "live/stream/stream_address.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// scheme://user:password@host -> scheme://host
std::string without_credentials(const std::string& url) {
  const std::size_t host = url.find("://") + 3;
  const std::size_t path = std::min(url.find('/', host), url.size());
  const std::size_t at = url.rfind('@', path);
  if (at == std::string::npos || at < host) return url;
  return url.substr(0, host) + url.substr(at + 1);
}

}  // namespace

StreamAddress parse_stream_address(const std::string& path) {
  constexpr auto kSchemes = std::to_array<std::pair<std::string_view, StreamKind>>(
      {{"rtsp://", StreamKind::rtsp}, {"rtp://", StreamKind::rtp}, {"udp://", StreamKind::udp}});
  constexpr std::string_view kDevice = "v4l2:";
  if (path == "-") return {.kind = StreamKind::standard_input, .url = path, .name = "stdin"};
  for (const auto& [scheme, kind] : kSchemes) {
    if (!path.starts_with(scheme)) continue;
    if (path.size() == scheme.size()) {
      throw InputError("source.path: " + path + " has no host; expected " + std::string(scheme) +
                       "HOST:PORT");
    }
    return {.kind = kind, .url = path, .name = without_credentials(path)};
  }
  if (path.starts_with(kDevice)) {
    return {.kind = StreamKind::device, .url = path.substr(kDevice.size()), .name = path};
  }
  if (path.ends_with(".sdp")) return {.kind = StreamKind::sdp, .url = path, .name = path};
  throw InputError(
      (path.empty() ? "source.path is not set" : "source.path: " + path + " is no live source") +
      "; expected rtsp://, rtp://, udp://, an .sdp file, v4l2:/dev/videoN or - (stillkite run "
      "reads files)");
}

}  // namespace stillkite
