#include "live/page/page_access.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

struct PageRoute {
  std::string_view method;
  std::string_view path;
  bool is_file;  // of the page: no secret
};
constexpr std::array kPageRoutes{
    PageRoute{"GET", "/", true},
    PageRoute{"GET", "/page.css", true},
    PageRoute{"GET", "/page.js", true},
    PageRoute{"GET", "/state", false},
    PageRoute{"GET", "/image", false},
    PageRoute{"POST", "/command", false},
    PageRoute{"POST", "/take_control", false},
    PageRoute{"POST", "/return_control", false},
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

// Host header without port and brackets.
std::string host_name(const std::string& host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return lower(host.substr(0, host.rfind(':')));
}

// DNS rebinding gives a name of somebody else's, never an address.
bool is_own_host(const std::string& host, const PageAccess& access) {
  const std::string name = host_name(host);
  return is_ip_address(name) || name == "localhost" ||
         (access.public_host && name == lower(*access.public_host));
}

bool is_own_origin(const std::string& origin, const std::string& host) {
  const std::string own = lower(host);
  return lower(origin) == "http://" + own || lower(origin) == "https://" + own;
}

// Time independent of the position of the first difference.
bool is_same_token(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

bool is_operator_id(std::string_view id) {
  constexpr std::size_t kIdCharacters = 32;
  return id.size() == kIdCharacters && std::ranges::all_of(id, [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

std::optional<PageRefusal> body_refusal(const PageRequest& request) {
  if (request.has_transfer_encoding) return PageRefusal{411, "a body needs a Content-Length"};
  const std::string& text = request.content_length;
  std::uint64_t length_bytes = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), length_bytes);
  const bool is_number = result.ec == std::errc() && result.ptr == text.data() + text.size();
  if (!text.empty() && !is_number) return PageRefusal{400, "invalid Content-Length"};
  if (request.method == "GET" && length_bytes > 0) return PageRefusal{400, "GET with a body"};
  if (request.method == "POST" && text.empty()) {
    return PageRefusal{411, "a body needs a Content-Length"};
  }
  if (length_bytes > kMaxPageBody_bytes) return PageRefusal{413, "the body is too long"};
  return std::nullopt;
}

}  // namespace

PageAccess page_access(const PageAddress& address, const std::optional<std::string>& public_host,
                       const char* token) {
  constexpr std::size_t kMinTokenCharacters = 16;
  PageAccess out{.public_host = public_host, .token = std::nullopt};
  const std::string_view text = token != nullptr ? token : "";
  if (!text.empty() && text.size() < kMinTokenCharacters) {
    throw InputError(std::string(kPageToken) + " is too short; at least 16 characters");
  }
  if (!text.empty()) out.token = text;
  if (!out.token && (!address.is_loopback || public_host)) {
    throw InputError("live.listen: a page that other machines reach needs a token; set " +
                     std::string(kPageToken) + " in the environment, or listen on 127.0.0.1");
  }
  return out;
}

std::optional<PageRefusal> page_refusal(const PageRequest& request, const PageAccess& access) {
  if (request.has_repeated_header) return PageRefusal{400, "repeated header"};
  if (!is_own_host(request.host, access)) {
    return PageRefusal{403, "unknown Host; use the address, or set live.public_host"};
  }
  if (!request.origin.empty() && !is_own_origin(request.origin, request.host)) {
    return PageRefusal{403, "request of another site"};
  }
  const auto* const route = std::ranges::find(kPageRoutes, request.path, &PageRoute::path);
  if (route == kPageRoutes.end()) return PageRefusal{404, "unknown path"};
  if (request.method != route->method) return PageRefusal{405, "unknown method"};
  if (auto refusal = body_refusal(request)) return refusal;
  if (route->is_file) return std::nullopt;
  if (access.token && !is_same_token(request.authorization, "Bearer " + *access.token)) {
    return PageRefusal{401, "wrong token"};
  }
  if (!is_operator_id(request.operator_id)) return PageRefusal{400, "invalid X-Operator"};
  return std::nullopt;
}

}  // namespace stillkite
