#pragma once

#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// One line to the operator with its time on the local clock.
struct OperatorMessage {
  Timestamp time;
  std::string text;
};

/// Last 20 lines to the operator. Thread-safe.
class MessageLog {
 public:
  void add(Timestamp time, const std::string& text) {
    constexpr std::size_t kKept = 20;
    const std::lock_guard lock(mutex_);
    messages_.push_back({time, text});
    if (messages_.size() > kKept) messages_.pop_front();
  }

  /// Oldest first.
  [[nodiscard]] std::vector<OperatorMessage> messages() const {
    const std::lock_guard lock(mutex_);
    return {messages_.begin(), messages_.end()};
  }

 private:
  mutable std::mutex mutex_;
  std::deque<OperatorMessage> messages_;
};

}  // namespace stillkite
