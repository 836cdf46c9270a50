#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "geometry/time.hpp"
#include "live/link/line_splitter.hpp"
#include "live/link/link_address.hpp"
#include "live/tether/watchdog.hpp"
#include "live/tether_config.hpp"

namespace stillkite {

/// Line of the ground station with its arrival on the local clock.
struct ReceivedLine {
  std::string line;
  Timestamp arrival;
};

/// Connection to the ground station through a supervising process, which owns the port and sets
/// all rates to zero if this process is silent or ends (TetherWatchdog).
class TetherLink {
 public:
  /// Forks the supervising process: no other thread may run yet. Throws InputError that names
  /// live.tether.port if the port cannot be opened.
  explicit TetherLink(const TetherConfig& config);
  /// Returns once the supervising process has ended: after an engagement in up to a second.
  ~TetherLink();
  TetherLink(const TetherLink&) = delete;
  TetherLink& operator=(const TetherLink&) = delete;

  void send(const TetherOrder& order);
  /// The supervising process appends its own holds to this commands.csv. `row_end`: the columns
  /// after the reason.
  void log_to(const std::string& file, const std::string& row_end);
  /// Lines since the last call, in the order of arrival. Call it at least every 0.1 s: if the
  /// supervising process has ended, it sends zero rates for a second instead.
  [[nodiscard]] std::vector<ReceivedLine> take();

  /// False once the supervising process has ended; nothing is commanded any more.
  [[nodiscard]] bool is_supervised() const { return !is_closed_; }
  [[nodiscard]] pid_t supervisor() const { return process_; }

 private:
  struct DirectPort;
  void send_zero();

  TetherConfig config_;
  LinkAddress address_;
  int socket_ = -1;
  pid_t process_ = -1;
  bool is_closed_ = false;
  TetherOrder last_;
  LineSplitter splitter_;
  std::unique_ptr<DirectPort> direct_;  // after the end of the supervising process
};

}  // namespace stillkite
