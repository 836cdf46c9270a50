#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// Limit of the request rate of each remote address: 100 per second, 200 at once (token bucket).
/// Keeps 64 addresses, which share one limit if there are more. Thread-safe.
class RequestRate {
 public:
  /// False if the address has exceeded its rate.
  [[nodiscard]] bool admit(const std::string& address, Timestamp now);

 private:
  struct Bucket {
    std::string address;
    double tokens;
    Timestamp updated;
  };
  Bucket& bucket_of(const std::string& address, Timestamp now);

  std::mutex mutex_;
  std::vector<Bucket> buckets_;
};

}  // namespace stillkite
