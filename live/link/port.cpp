#include "live/link/port.hpp"

#include <array>
#include <asio/buffer.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <asio/post.hpp>
#include <asio/serial_port.hpp>
#include <asio/steady_timer.hpp>
#include <asio/write.hpp>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "live/clock/local_clock.hpp"
#include "live/link/serial_device.hpp"

namespace stillkite {
namespace {

using asio::ip::udp;
constexpr double kSenderTimeout_s = 2;
constexpr std::chrono::seconds kTick{1};
constexpr std::size_t kMaxWaiting_bytes = 2048;  // 0.2 s at 115200 baud

}  // namespace

struct Port::State {
  State(LinkAddress to, std::string config_key, Receive on_bytes, Tick on_tick)
      : address(std::move(to)),
        key(std::move(config_key)),
        receive(std::move(on_bytes)),
        tick(std::move(on_tick)) {}

  void open_udp();
  void receive_udp();
  void receive_serial();
  void wait_for_tick();
  void send(const std::vector<std::uint8_t>& bytes);
  void write_serial();
  [[nodiscard]] bool accepts_sender(Timestamp now);

  LinkAddress address;
  std::string key;
  Receive receive;
  Tick tick;
  asio::io_context io{1};
  udp::socket socket{io};
  asio::serial_port serial{io};
  asio::steady_timer timer{io};
  std::array<std::uint8_t, 4096> buffer{};
  udp::endpoint sender;
  std::optional<udp::endpoint> peer;
  Timestamp peer_heard;
  std::vector<std::uint8_t> waiting, writing;  // bytes for the serial port
  std::thread thread;
};

void Port::State::open_udp() {
  asio::error_code error;
  if (address.host.empty()) {
    socket.open(udp::v4(), error);
    if (!error) socket.bind({udp::v4(), address.port}, error);
  } else {
    udp::resolver resolver(io);
    const auto found =
        resolver.resolve(udp::v4(), address.host, std::to_string(address.port), error);
    if (!error) peer = *found.begin();
    if (!error) socket.open(udp::v4(), error);
    if (!error) socket.bind({udp::v4(), 0}, error);
  }
  if (!error) socket.non_blocking(true, error);  // a full buffer drops the datagram
  if (!error) return;
  throw InputError(key + ": udp://" + address.host + ":" + std::to_string(address.port) +
                   " cannot be opened: " + error.message() + "; choose another port or host");
}

bool Port::State::accepts_sender(Timestamp now) {
  if (!address.host.empty()) return true;
  if (peer && *peer != sender && seconds_between(peer_heard, now) < kSenderTimeout_s) return false;
  peer = sender;
  peer_heard = now;
  return true;
}

void Port::State::receive_udp() {
  socket.async_receive_from(asio::buffer(buffer), sender,
                            [this](const asio::error_code& error, std::size_t size) {
                              if (error == asio::error::operation_aborted) return;
                              // others: a datagram that was refused by the peer
                              const Timestamp now = local_now();
                              if (!error && accepts_sender(now))
                                receive(std::span(buffer).first(size), now);
                              receive_udp();
                            });
}

void Port::State::receive_serial() {
  serial.async_read_some(asio::buffer(buffer),
                         [this](const asio::error_code& error, std::size_t size) {
                           if (error == asio::error::operation_aborted) return;
                           asio::error_code ignored;
                           if (error) return static_cast<void>(serial.close(ignored));
                           receive(std::span(buffer).first(size), local_now());
                           receive_serial();
                         });
}

void Port::State::wait_for_tick() {
  timer.expires_after(kTick);
  timer.async_wait([this](const asio::error_code& error) {
    if (error) return;
    const bool is_serial = address.kind == LinkAddress::Kind::serial;
    if (is_serial && !serial.is_open() && open_serial_device(serial, address)) receive_serial();
    tick();
    wait_for_tick();
  });
}

// What the link cannot carry is dropped: the next estimate is newer anyway.
void Port::State::send(const std::vector<std::uint8_t>& bytes) {
  if (address.kind == LinkAddress::Kind::serial) {
    if (!serial.is_open() || waiting.size() + bytes.size() > kMaxWaiting_bytes) return;
    waiting.insert(waiting.end(), bytes.begin(), bytes.end());
    if (writing.empty()) write_serial();
  } else if (peer) {
    asio::error_code ignored;
    socket.send_to(asio::buffer(bytes), *peer, 0, ignored);
  }
}

void Port::State::write_serial() {
  writing.swap(waiting);
  asio::async_write(serial, asio::buffer(writing),
                    [this](const asio::error_code& error, std::size_t /*size*/) {
                      writing.clear();
                      if (error) return waiting.clear();
                      if (!waiting.empty()) write_serial();
                    });
}

Port::Port(const LinkAddress& address, const std::string& key, Receive receive, Tick tick)
    : state_(std::make_unique<State>(address, key, std::move(receive), std::move(tick))) {
  if (address.kind == LinkAddress::Kind::udp) {
    state_->open_udp();
  } else if (!open_serial_device(state_->serial, address)) {
    throw InputError(
        key + ": " + address.host +
        " cannot be opened; check the device, its baud rate, and the permission to read and "
        "write it; no other program may use it");
  }
}

Port::~Port() {
  state_->io.stop();
  if (state_->thread.joinable()) state_->thread.join();
}

void Port::start() {
  State& s = *state_;
  if (s.address.kind == LinkAddress::Kind::udp) {
    s.receive_udp();
  } else {
    s.receive_serial();
  }
  s.wait_for_tick();
  s.thread = std::thread([&s] { s.io.run(); });
}

void Port::send(std::span<const std::uint8_t> bytes) {
  State& s = *state_;
  asio::post(s.io, [&s, copy = std::vector(bytes.begin(), bytes.end())] { s.send(copy); });
}

}  // namespace stillkite
