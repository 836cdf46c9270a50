#include "live/tether/tether_link.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <asio/io_context.hpp>
#include <asio/serial_port.hpp>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "geometry/fields.hpp"
#include "live/clock/local_clock.hpp"
#include "live/link/serial_device.hpp"
#include "live/tether/command_lines.hpp"
#include "live/tether/supervisor.hpp"

namespace stillkite {
namespace {

LinkAddress serial_address(const TetherConfig& config) {
  const std::string port = config.port.value_or("");
  if (port.starts_with("serial:")) return parse_link_address(port, "live.tether.port");
  throw InputError("live.tether.port: " + port + " is no serial port; expected serial:DEVICE:BAUD");
}

// Runs in the new process: a session of its own, so that signals of the terminal do not reach it,
// and no hold on pipes that others read.
[[noreturn]] void run_supervisor(int socket, const LinkAddress& address,
                                 const TetherConfig& config) {
  setsid();
  const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (null >= 0) {
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
  }
  try {
    supervise(socket, address, config);
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

// Waits for the first message.
bool is_port_open(int socket) {
  constexpr int kMaxWait_ms = 5000;
  pollfd waiting{.fd = socket, .events = POLLIN, .revents = 0};
  while (poll(&waiting, 1, kMaxWait_ms) < 0 && errno == EINTR) {
  }
  bool is_closed = false;
  const auto message = receive_message(socket, is_closed);
  return message && message->kind == SupervisorMessage::ready;
}

}  // namespace

struct TetherLink::DirectPort {
  asio::io_context io{1};
  asio::serial_port serial{io};
  Timestamp since = local_now();
};

TetherLink::TetherLink(const TetherConfig& config)
    : config_(config), address_(serial_address(config)) {
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "live.tether: no socket");
  }
  process_ = fork();
  if (process_ == 0) {
    close(sockets[0]);
    run_supervisor(sockets[1], address_, config_);
  }
  const int failure = errno;
  close(sockets[1]);
  socket_ = sockets[0];
  if (process_ > 0 && is_port_open(socket_)) return;
  close(socket_);
  if (process_ < 0) {
    throw std::system_error(failure, std::generic_category(), "live.tether: no second process");
  }
  waitpid(process_, nullptr, 0);
  throw InputError("live.tether.port: " + address_.host +
                   " cannot be opened; check the device, its baud rate, and the permission to read "
                   "and write it; no other program may use it");
}

TetherLink::~TetherLink() {
  if (!is_closed_) send({});
  close(socket_);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void TetherLink::send(const TetherOrder& order) {
  last_ = order;
  std::array<char, sizeof order> bytes{};
  std::memcpy(bytes.data(), &order, sizeof order);
  send_message(socket_, SupervisorMessage::order, {bytes.data(), bytes.size()});
}

void TetherLink::log_to(const std::string& file, const std::string& row_end) {
  send_message(socket_, SupervisorMessage::log, row_end + '\n' + file);
}

std::vector<ReceivedLine> TetherLink::take() {
  std::vector<ReceivedLine> out;
  while (!is_closed_) {
    const auto message = receive_message(socket_, is_closed_);
    if (!message) break;
    std::int64_t arrival_ns = 0;
    if (message->kind != SupervisorMessage::received ||
        message->content.size() < sizeof arrival_ns) {
      continue;
    }
    std::memcpy(&arrival_ns, message->content.data(), sizeof arrival_ns);
    splitter_.add(std::span(message->content).subspan(sizeof arrival_ns));
    while (auto line = splitter_.next()) out.push_back({std::move(*line), {arrival_ns}});
  }
  if (is_closed_) send_zero();
  return out;
}

// The port is free again: the supervising process has ended.
void TetherLink::send_zero() {
  if (!last_.is_engaged) return;
  if (!direct_) {
    direct_ = std::make_unique<DirectPort>();
    if (!open_serial_device(direct_->serial, address_)) return;
  }
  const Timestamp now = local_now();
  if (!direct_->serial.is_open()) return;
  if (seconds_between(direct_->since, now) > TetherWatchdog::kRepeat_s) {
    last_ = {};
    direct_.reset();
    return;
  }
  const std::string lines = CommandLines(config_).lines({}, now);
  static_cast<void>(!::write(direct_->serial.native_handle(), lines.data(), lines.size()));
}

}  // namespace stillkite
