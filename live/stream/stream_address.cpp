#include "live/stream/stream_address.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

struct UrlParts {
  std::string scheme, user, rest;  // scheme:// user:password@ host/path
};

UrlParts split(const std::string& url) {
  const std::size_t separator = url.find("://");
  if (separator == std::string::npos) return {.rest = url};
  const std::size_t host = separator + 3;
  const std::size_t path = std::min(url.find('/', host), url.size());
  const std::size_t at = url.rfind('@', path);
  const std::size_t end = at == std::string::npos || at < host ? host : at + 1;
  return {url.substr(0, host), url.substr(host, end - host), url.substr(end)};
}

std::string name_of_url(const std::string& url) {
  const UrlParts parts = split(url);
  return parts.scheme + parts.rest.substr(0, parts.rest.find('?'));
}

bool has_port(const std::string& url) {
  const std::string host = split(url).rest;
  const std::size_t colon = host.rfind(':', host.find_first_of("/?"));
  return colon != std::string::npos && std::isdigit(static_cast<unsigned char>(host[colon + 1]));
}

}  // namespace

std::string without_password(const std::string& path) {
  const UrlParts parts = split(path);
  return parts.user.find("${") == std::string::npos ? parts.scheme + parts.rest : path;
}

StreamAddress parse_stream_address(const std::string& path) {
  constexpr auto kSchemes = std::to_array<std::pair<std::string_view, StreamKind>>(
      {{"rtsp://", StreamKind::rtsp}, {"rtp://", StreamKind::rtp}, {"udp://", StreamKind::udp}});
  constexpr std::string_view kDevice = "v4l2:";
  if (path == "-") return {.kind = StreamKind::standard_input, .url = path, .name = "stdin"};
  for (const auto& [scheme, kind] : kSchemes) {
    if (!path.starts_with(scheme)) continue;
    const std::string name = name_of_url(path);
    if (name.size() == scheme.size() || (kind != StreamKind::rtsp && !has_port(path))) {
      throw InputError("source.path: " + name + " has no host or port; expected " +
                       std::string(scheme) + "HOST:PORT");
    }
    return {.kind = kind, .url = path, .name = name};
  }
  if (path.starts_with(kDevice)) {
    return {.kind = StreamKind::device, .url = path.substr(kDevice.size()), .name = path};
  }
  if (path.ends_with(".sdp")) return {.kind = StreamKind::sdp, .url = path, .name = path};
  throw InputError(
      (path.empty() ? "source.path is not set"
                    : "source.path: " + name_of_url(path) + " is no live source") +
      "; expected rtsp://, rtp://, udp://, an .sdp file, v4l2:/dev/videoN or - (stillkite run "
      "reads files)");
}

}  // namespace stillkite
