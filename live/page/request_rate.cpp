#include "live/page/request_rate.hpp"

#include <algorithm>

namespace stillkite {
namespace {

constexpr double kRequestsPer_s = 100, kRequestBurst = 200;
constexpr std::size_t kMaxAddresses = 64;

}  // namespace

RequestRate::Bucket& RequestRate::bucket_of(const std::string& address, Timestamp now) {
  const auto found = std::ranges::find(buckets_, address, &Bucket::address);
  if (found != buckets_.end()) return *found;
  // a full bucket limits nothing and is not kept
  std::erase_if(buckets_, [&](const Bucket& bucket) {
    return bucket.tokens + kRequestsPer_s * seconds_between(bucket.updated, now) >= kRequestBurst;
  });
  if (buckets_.size() >= kMaxAddresses) return buckets_.front();
  return buckets_.emplace_back(Bucket{address, kRequestBurst, now});
}

bool RequestRate::admit(const std::string& address, Timestamp now) {
  const std::lock_guard lock(mutex_);
  Bucket& bucket = bucket_of(address, now);
  const double refill = kRequestsPer_s * seconds_between(bucket.updated, now);
  bucket.tokens = std::min(bucket.tokens + refill, kRequestBurst);
  bucket.updated = now;
  if (bucket.tokens < 1) return false;
  --bucket.tokens;
  return true;
}

}  // namespace stillkite
