#pragma once

#include <httplib.h>

#include <array>
#include <chrono>
#include <functional>
#include <utility>

namespace stillkite {

/// Connection of a browser: each request is bounded in size and time, reading and writing together.
/// The library bounds neither the number of headers nor the time of a request.
class PageConnection final : public httplib::Stream {
 public:
  /// `is_ended`: ends waiting, in mid-request, too.
  PageConnection(int socket, std::function<bool()> is_ended)
      : socket_(socket), is_ended_(std::move(is_ended)) {}

  /// Waits for the first byte of a request, at most 5 s. False without one.
  [[nodiscard]] bool wait_for_request();

  [[nodiscard]] bool is_readable() const override;
  [[nodiscard]] bool is_writable() const override;
  /// -1 once the limit is exceeded.
  ssize_t read(char* to, size_t size) override;
  ssize_t write(const char* from, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] bool wait(short event, Clock::time_point end) const;

  int socket_;
  std::function<bool()> is_ended_;
  Clock::time_point deadline_;
  std::size_t budget_bytes_ = 0;
  std::array<char, 4096> buffer_{};  // the library reads single bytes
  std::size_t begin_ = 0, end_ = 0;  // of what is not read yet
};

}  // namespace stillkite
