#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace stillkite {

/// Splits a stream of bytes into lines. Lines longer than the limit are dropped.
class LineSplitter {
 public:
  explicit LineSplitter(std::size_t max_line_bytes = 256) : max_line_bytes_(max_line_bytes) {}

  void add(std::span<const char> bytes) { waiting_.append(bytes.data(), bytes.size()); }

  /// Next complete line without its end; empty lines are skipped. nullopt until its end arrives.
  [[nodiscard]] std::optional<std::string> next();

  /// Number of lines that were longer than the limit.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  std::size_t max_line_bytes_;
  std::string waiting_;
  bool is_overlong_ = false;  // a dropped line has not ended yet
  std::int64_t dropped_ = 0;
};

}  // namespace stillkite
