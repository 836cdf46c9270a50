#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "geometry/time.hpp"
#include "live/link/link_address.hpp"

namespace stillkite {

/// Open UDP or serial port with a thread that receives.
///
/// A UDP port that listens answers to the first sender; others are ignored until that one has been
/// silent for two seconds. A serial port that fails is opened again each second.
class Port {
 public:
  /// Receives bytes with their arrival on the local clock, on the port's thread.
  using Receive = std::function<void(std::span<const std::uint8_t>, Timestamp)>;
  /// Called once per second, on the port's thread.
  using Tick = std::function<void()>;

  /// Throws InputError if the port cannot be opened.
  Port(const LinkAddress& address, const std::string& key, Receive receive, Tick tick);
  ~Port();
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  /// Starts the thread; the callbacks are called from then on.
  void start();

  /// Sends one datagram, or bytes of a stream. Dropped without a peer. Thread-safe.
  void send(std::span<const std::uint8_t> bytes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
