#include "live/operator/operator_input.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "live/clock/local_clock.hpp"

namespace stillkite {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr std::size_t kMaxOperatorLine_bytes = 4096;

// True for a socket whose process has been killed.
bool is_abandoned(const sockaddr_un& address) {
  std::error_code ignored;
  if (!std::filesystem::is_socket(address.sun_path, ignored)) return false;
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  const bool is_refused =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 &&
      errno == ECONNREFUSED;
  close(descriptor);
  return is_refused;
}

int bind_operator_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    throw InputError(fmt::format("live.operator: unix:{}: the path must have 1 to {} bytes", path,
                                 sizeof address.sun_path - 1));
  }
  std::memcpy(address.sun_path, path.c_str(), path.size());
  if (is_abandoned(address)) unlink(path.c_str());
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t others = umask(0177);  // from its creation on, only for this user
  const bool is_bound =
      descriptor >= 0 &&
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int error = errno;
  umask(others);
  if (is_bound) return descriptor;
  if (descriptor >= 0) close(descriptor);
  throw InputError(
      fmt::format("live.operator: unix:{} cannot be created: {}; remove it if no "
                  "other flight uses it, or choose another path",
                  path, std::strerror(error)));
}

}  // namespace

OperatorInput::OperatorInput(const std::string& source) {
  if (source == "-") {
    descriptor_ = STDIN_FILENO;
  } else if (source.starts_with(kUnix)) {
    descriptor_ = bind_operator_socket(source.substr(kUnix.size()));
    path_ = source.substr(kUnix.size());
  } else {
    throw InputError("live.operator: " + source + " is no source; expected - or unix:PATH");
  }
}

OperatorInput::~OperatorInput() {
  if (path_.empty()) return;
  close(descriptor_);
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

int OperatorInput::read_into(OperatorQueue& queue) {
  int invalid = 0;
  std::array<char, 2048> bytes{};
  while (!has_ended_) {
    pollfd ready{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, 0) <= 0) break;
    const ssize_t size = read(descriptor_, bytes.data(), bytes.size());
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) break;
    // an empty datagram is no end
    if (size < 0 || (size == 0 && path_.empty())) has_ended_ = true;
    if (size <= 0) continue;
    waiting_.append(bytes.data(), static_cast<std::size_t>(size));
    if (!path_.empty()) waiting_ += '\n';  // a datagram is a line
    const Timestamp arrival = local_now();
    for (std::size_t end = waiting_.find('\n'); end != std::string::npos;
         end = waiting_.find('\n')) {
      const std::string line = waiting_.substr(0, end);
      waiting_.erase(0, end + 1);
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (auto command = parse_operator_command(line, arrival)) {
        queue.push(std::move(*command));
      } else {
        ++invalid;
      }
    }
    if (waiting_.size() > kMaxOperatorLine_bytes) {
      waiting_.clear();
      ++invalid;
    }
  }
  return invalid;
}

}  // namespace stillkite
