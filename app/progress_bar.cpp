#include "app/progress_bar.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

std::string clock_text(double seconds) {
  const auto whole = std::llround(seconds);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

std::string progress_line(const std::string& label, std::int64_t done,
                          std::optional<std::int64_t> expected, double elapsed_s) {
  const double rate = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0;
  if (!expected || *expected <= 0) return fmt::format("{} {}  {:.1f}/s", label, done, rate);
  constexpr int kWidth = 30;
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(*expected));
  const int filled = static_cast<int>(share * kWidth);
  const double left_s = rate > 0 ? static_cast<double>(*expected - done) / rate : 0;
  return fmt::format("{} [{:#<{}}{:.<{}}] {:3.0f} %  {}/{}  {:.1f}/s  {} left", label, "", filled,
                     "", kWidth - filled, 100 * share, done, *expected, rate,
                     rate > 0 ? clock_text(std::max(0.0, left_s)) : "?");
}

ProgressBar::ProgressBar(std::string label, std::optional<std::int64_t> expected)
    : label_(std::move(label)), expected_(expected), on_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_ && last_drawn_ != Clock::time_point{}) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::step() {
  ++done_;
  if (!on_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_drawn_ < std::chrono::milliseconds(200)) return;
  last_drawn_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  fmt::print(stderr, "\r{}\x1b[K", progress_line(label_, done_, expected_, elapsed_s));
  std::fflush(stderr);
}

}  // namespace stillkite
