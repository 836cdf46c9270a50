#include "live/page/page_connection.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace stillkite {
namespace {

constexpr std::chrono::seconds kMaxRequestTime{5}, kMaxIdle{5};
constexpr std::size_t kMaxRequest_bytes = 16'384;

using AddressOf = int (*)(int, sockaddr*, socklen_t*);

// Address of one end of the connection, by getpeername or getsockname.
void read_address(int socket, AddressOf address_of, std::string& ip, int& port) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  auto* const address = reinterpret_cast<sockaddr*>(&storage);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  if (address_of(socket, address, &size) != 0 ||
      getnameinfo(address, size, host.data(), host.size(), service.data(), service.size(),
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return;
  }
  ip = host.data();
  std::from_chars(service.data(), service.data() + std::strlen(service.data()), port);
}

}  // namespace

bool PageConnection::wait_for_request() {
  if (begin_ == end_ && !wait(POLLIN, Clock::now() + kMaxIdle)) return false;
  deadline_ = Clock::now() + kMaxRequestTime;
  budget_bytes_ = kMaxRequest_bytes;
  return true;
}

bool PageConnection::wait(short event, Clock::time_point end) const {
  constexpr int kStep_ms = 200;
  while (Clock::now() < end && !is_ended_()) {
    pollfd ready{.fd = socket_, .events = event, .revents = 0};
    if (poll(&ready, 1, kStep_ms) > 0) return true;
  }
  return false;
}

bool PageConnection::is_readable() const {
  return budget_bytes_ > 0 && (begin_ < end_ || wait(POLLIN, deadline_));
}

bool PageConnection::is_writable() const {
  return wait(POLLOUT, deadline_);
}

ssize_t PageConnection::read(char* to, size_t size) {
  if (!is_readable() || Clock::now() > deadline_) return -1;
  if (begin_ == end_) {
    const ssize_t received = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (received <= 0) return received;
    begin_ = 0;
    end_ = static_cast<std::size_t>(received);
  }
  const std::size_t count = std::min({size, end_ - begin_, budget_bytes_});
  std::memcpy(to, buffer_.data() + begin_, count);
  begin_ += count;
  budget_bytes_ -= count;
  return static_cast<ssize_t>(count);
}

ssize_t PageConnection::write(const char* from, size_t size) {
  if (!is_writable()) return -1;
  return send(socket_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

void PageConnection::get_remote_ip_and_port(std::string& ip, int& port) const {
  read_address(socket_, getpeername, ip, port);
}

void PageConnection::get_local_ip_and_port(std::string& ip, int& port) const {
  read_address(socket_, getsockname, ip, port);
}

}  // namespace stillkite
