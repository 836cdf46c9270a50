#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/time.hpp"
#include "live/link/link_address.hpp"
#include "live/tether/watchdog.hpp"
#include "live/tether_config.hpp"

namespace stillkite {

// Messages over the socket between the estimator's process and the supervising one, one a packet:
// a kind, then its content.

inline constexpr std::size_t kMaxMessage_bytes = 4096;

enum class SupervisorMessage : char {
  order = 'O',     ///< to the supervisor: TetherOrder
  log = 'L',       ///< to the supervisor: end of a row of commands.csv, a line feed, path
  ready = 'R',     ///< from the supervisor: the port is open
  no_port = 'N',   ///< from the supervisor: the port cannot be opened
  received = 'B',  ///< from the supervisor: arrival [ns], bytes of the port
};

/// Owns the ground station's port until the socket is closed by the other process and the zero
/// rates are sent, then returns. Single thread; ignores SIGINT, SIGTERM and SIGHUP.
void supervise(int socket, const LinkAddress& address, const TetherConfig& config);

/// Message with its kind, at most kMaxMessage_bytes. False if the socket is closed or full.
bool send_message(int socket, SupervisorMessage kind, std::string_view content);

struct ReceivedMessage {
  SupervisorMessage kind{};
  std::string content;
};
/// Next message; nullopt without one. `is_closed` is set once the other process has ended.
[[nodiscard]] std::optional<ReceivedMessage> receive_message(int socket, bool& is_closed);

}  // namespace stillkite
