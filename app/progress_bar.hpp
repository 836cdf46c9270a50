#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace stillkite {

/// One line on stderr with the share done, the rate and the time left, redrawn a few times a
/// second; silent where stderr is no terminal. The line is wiped when the bar goes.
class ProgressBar {
 public:
  /// `expected`: steps in all, where that is known.
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

/// The line that the bar shows, without control characters.
[[nodiscard]] std::string progress_line(const std::string& label, std::int64_t done,
                                        std::optional<std::int64_t> expected, double elapsed_s);

}  // namespace stillkite
