#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace stillkite {

/// Progress line on stderr: share, rate and time left, redrawn five times per second. Prints
/// nothing if stderr is not a terminal. The destructor erases the line.
class ProgressBar {
 public:
  /// `expected`: total number of steps, if available.
  ProgressBar(std::string label, std::optional<std::int64_t> expected);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void step();

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::optional<std::int64_t> expected_;
  std::int64_t done_ = 0;
  bool on_terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_{};
};

/// Text of the progress line, without control characters.
[[nodiscard]] std::string progress_line(const std::string& label, std::int64_t done,
                                        std::optional<std::int64_t> expected, double elapsed_s);

}  // namespace stillkite
