#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace stillkite {

/// One-slot mailbox between two threads: the newest value replaces an older one.
template <typename T>
class Mailbox {
 public:
  /// Stores a value. Returns the value that nobody has taken and that it replaces.
  std::optional<T> put(T value) {
    const std::lock_guard lock(mutex_);
    std::optional<T> replaced = std::exchange(value_, std::move(value));
    changed_.notify_one();
    return replaced;
  }

  /// Takes the value; waits for one at most `wait_s`, or until the mailbox is closed.
  std::optional<T> take(double wait_s) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(wait_s),
                      [this] { return closed_ || value_.has_value(); });
    return std::exchange(value_, std::nullopt);
  }

  /// No further value follows.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }
  [[nodiscard]] bool is_closed_and_empty() {
    const std::lock_guard lock(mutex_);
    return closed_ && !value_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> value_;
  bool closed_ = false;
};

}  // namespace stillkite
