#include "live/tether/supervisor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <asio/io_context.hpp>
#include <asio/serial_port.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "live/clock/local_clock.hpp"
#include "live/link/serial_device.hpp"
#include "live/tether/command_lines.hpp"

namespace stillkite {
namespace {

constexpr double kPeriod_s = 0.05;
constexpr double kReopen_s = 1;

void report_tether(const std::string& message) {
  std::fputs(fmt::format("stillkite: tether: {}\n", message).c_str(), stderr);
}

/// State of the supervising process.
class Supervisor {
 public:
  Supervisor(int socket, const LinkAddress& address, const TetherConfig& config)
      : socket_(socket), address_(address), watchdog_(config.max_unmeasured_s), lines_(config) {}

  [[nodiscard]] bool open() { return open_serial_device(serial_, address_); }

  void run() {
    send_message(socket_, SupervisorMessage::ready, {});
    while (!is_over()) {
      wait();
      receive_orders();
      receive_bytes();
      if (seconds_between(last_tick_, local_now()) >= kPeriod_s) tick();
      write();
    }
  }

 private:
  [[nodiscard]] bool is_over() const {
    return is_closed_ && !watchdog_.output(local_now()).command;
  }

  void wait() {
    const double remaining_s = kPeriod_s - seconds_between(last_tick_, local_now());
    const int wait_ms = std::max(0, static_cast<int>(1e3 * remaining_s) + 1);
    std::array<pollfd, 2> waiting{};
    waiting[0] = {.fd = is_closed_ ? -1 : socket_, .events = POLLIN, .revents = 0};
    const int port = serial_.is_open() ? serial_.native_handle() : -1;
    const bool writes = !writing_.empty() || !next_.empty();
    waiting[1] = {
        .fd = port, .events = static_cast<short>(writes ? POLLIN | POLLOUT : POLLIN), .revents = 0};
    poll(waiting.data(), waiting.size(), wait_ms);
  }

  void receive_orders() {
    while (!is_closed_) {
      const auto message = receive_message(socket_, is_closed_);
      if (!message) break;
      if (message->kind == SupervisorMessage::log) open_log(message->content);
      if (message->kind != SupervisorMessage::order ||
          message->content.size() != sizeof(TetherOrder)) {
        continue;
      }
      TetherOrder order;
      std::memcpy(&order, message->content.data(), sizeof order);
      const Timestamp now = local_now();
      watchdog_.receive(order, now);
      put(watchdog_.output(now), now);
    }
    if (is_closed_ && !has_ended_) {
      has_ended_ = true;
      const Timestamp now = local_now();
      watchdog_.end(now);
      put(watchdog_.output(now), now);
    }
  }

  // A command of the estimator is sent once; zero rates are repeated.
  void tick() {
    const Timestamp now = local_now();
    last_tick_ = now;
    const TetherWatchdog::Output output = watchdog_.output(now);
    if (output.reason != HoldReason::none) put(output, now);
    if (serial_.is_open() || seconds_between(last_open_, now) < kReopen_s) return;
    last_open_ = now;
    if (open()) report_tether(address_.host + ": opened again");
  }

  void put(const TetherWatchdog::Output& output, Timestamp now) {
    report_change(output, now);
    if (output.command) next_ = lines_.lines(*output.command, now);
  }

  // Zero rates that this process has set, not the estimator.
  void report_change(const TetherWatchdog::Output& output, Timestamp now) {
    const bool is_own = output.command && (output.reason == HoldReason::estimator_silent ||
                                           output.reason == HoldReason::estimator_ended ||
                                           output.reason == HoldReason::not_measured);
    const HoldReason reason = is_own ? output.reason : HoldReason::none;
    if (reason == last_reason_) return;
    last_reason_ = reason;
    if (reason == HoldReason::none) return;
    report_tether(fmt::format("all rates zero: {}", name_of(reason)));
    const std::string row = fmt::format("{},hold,{},{}\n", now.ns, name_of(reason), log_row_);
    if (log_ >= 0 && ::write(log_, row.data(), row.size()) < 0) {
      report_tether("commands.csv cannot be written");
    }
  }

  void open_log(const std::string& content) {
    const std::size_t end = content.find('\n');
    if (end == std::string::npos) return;
    log_row_ = content.substr(0, end);
    log_ = ::open(content.c_str() + end + 1, O_WRONLY | O_APPEND | O_CLOEXEC);
  }

  void lose_port() {
    asio::error_code ignored;
    serial_.close(ignored);
    writing_.clear();
    last_open_ = local_now();
    report_tether(address_.host + ": lost; opening it again");
  }

  void receive_bytes() {
    std::array<char, 1024> bytes{};
    while (serial_.is_open()) {
      const ssize_t size = ::read(serial_.native_handle(), bytes.data(), bytes.size());
      if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
      if (size <= 0) return lose_port();
      const std::int64_t arrival_ns = local_now().ns;
      std::string content(sizeof arrival_ns, '\0');
      std::memcpy(content.data(), &arrival_ns, sizeof arrival_ns);
      content.append(bytes.data(), static_cast<std::size_t>(size));
      if (!is_closed_) send_message(socket_, SupervisorMessage::received, content);
    }
  }

  // A line that has been started is finished; of those that wait, only the newest are kept.
  void write() {
    while (serial_.is_open()) {
      if (writing_.empty()) writing_.swap(next_);
      if (writing_.empty()) return;
      const ssize_t size = ::write(serial_.native_handle(), writing_.data(), writing_.size());
      if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
      if (size < 0) return lose_port();
      writing_.erase(0, static_cast<std::size_t>(size));
    }
    next_.clear();
  }

  int socket_;
  LinkAddress address_;
  TetherWatchdog watchdog_;
  CommandLines lines_;
  asio::io_context io_{1};
  asio::serial_port serial_{io_};
  std::string writing_, next_;
  std::string log_row_;
  int log_ = -1;
  HoldReason last_reason_ = HoldReason::none;
  Timestamp last_tick_ = local_now(), last_open_ = local_now();
  bool is_closed_ = false, has_ended_ = false;
};

}  // namespace

void supervise(int socket, const LinkAddress& address, const TetherConfig& config) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
  Supervisor supervisor(socket, address, config);
  if (supervisor.open()) {
    supervisor.run();
  } else {
    send_message(socket, SupervisorMessage::no_port, {});
  }
}

bool send_message(int socket, SupervisorMessage kind, std::string_view content) {
  std::string packet(1, static_cast<char>(kind));
  packet += content;
  return packet.size() <= kMaxMessage_bytes &&
         send(socket, packet.data(), packet.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
             static_cast<ssize_t>(packet.size());
}

std::optional<ReceivedMessage> receive_message(int socket, bool& is_closed) {
  std::array<char, kMaxMessage_bytes> packet{};
  while (true) {
    const ssize_t size = recv(socket, packet.data(), packet.size(), MSG_DONTWAIT);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && errno == EAGAIN) return std::nullopt;
    if (size <= 0) {
      is_closed = true;
      return std::nullopt;
    }
    return ReceivedMessage{
        .kind = static_cast<SupervisorMessage>(packet[0]),
        .content = std::string(packet.data() + 1, static_cast<std::size_t>(size) - 1)};
  }
}

}  // namespace stillkite
