#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "live/page/page_address.hpp"

namespace stillkite {

/// Environment variable of the page's token.
inline constexpr const char* kPageToken = "STILLKITE_PAGE_TOKEN";

/// Who may use the operator's page.
struct PageAccess {
  std::optional<std::string> public_host;  ///< name of a reverse proxy, as browsers know it
  std::optional<std::string> token;        ///< required of every request but the page's files
};

/// `token`: value of STILLKITE_PAGE_TOKEN; an empty one counts as absent. Throws InputError if it
/// is shorter than 16 characters, or absent although the address is not loopback or there is a
/// public host.
[[nodiscard]] PageAccess page_access(const PageAddress& address,
                                     const std::optional<std::string>& public_host,
                                     const char* token);

/// Parts of a request that decide whether it is answered. Absent headers are empty.
struct PageRequest {
  std::string method;
  std::string path;
  std::string host;
  std::string origin;
  std::string authorization;
  std::string operator_id;  ///< header X-Operator: random number of one browser tab
  std::string content_length;
  bool has_transfer_encoding = false;
  bool has_repeated_header = false;  ///< of those above
};

/// Answer to a request that is refused.
struct PageRefusal {
  int status = 400;    ///< HTTP
  std::string reason;  ///< for the operator
};

/// Largest body of a request, in bytes.
inline constexpr std::uint64_t kMaxPageBody_bytes = 1000;

/// Reason to refuse a request; nullopt if it is answered. Checks
/// - Host: an IP address, localhost or the public host, so that no other name is rebound to us;
/// - Origin, if present: this page;
/// - path and method: those of the page;
/// - length of the body; token and operator, except for the page's files.
[[nodiscard]] std::optional<PageRefusal> page_refusal(const PageRequest& request,
                                                      const PageAccess& access);

}  // namespace stillkite
