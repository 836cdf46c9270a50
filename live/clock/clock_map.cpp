#include "live/clock/clock_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace stillkite {
namespace {

constexpr double kBucket_s = 0.25;
constexpr std::int64_t kBuckets = 240;
constexpr double kMaxSkew = 1e-3;  // quartz: 1e-4; encoders that count frames err more
constexpr double kStep_s = 1;
constexpr double kLate_s = 5;

struct Point {
  double x_s = 0, y_s = 0;
};

// Cross product of (b - a) and (c - a): positive if c is above the line through a and b.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x_s - a.x_s) * (c.y_s - a.y_s) - (b.y_s - a.y_s) * (c.x_s - a.x_s);
}

}  // namespace

FilteredStamp ClockMap::map(std::int64_t sender_ns, Timestamp arrival) {
  const auto x_of = [&] { return 1e-9 * static_cast<double>(sender_ns - first_sender_ns_); };
  const auto y_of = [&] { return seconds_between(first_arrival_, arrival) - x_of(); };
  if (buckets_.empty() || has_stepped(x_of(), y_of())) restart(sender_ns, arrival);
  const double x_s = last_x_s_ = x_of();
  add(x_s, y_of());
  fit();
  const Sums all = sums();
  // error of a minimum of n delays, extrapolated to the end of the window
  constexpr double kExtrapolation = 4;
  return {.stamp = {first_arrival_.ns + (sender_ns - first_sender_ns_) +
                    std::llround(1e9 * line_s(x_s))},
          .sigma_s = all.count < 2 ? std::numeric_limits<double>::infinity()
                                   : kExtrapolation * mean_delay_s() / all.count};
}

double ClockMap::mean_delay_s() const {
  const Sums all = sums();
  return all.count == 0 ? 0 : std::max(0.0, (all.y_s - slope_ * all.x_s) / all.count - offset_s_);
}

bool ClockMap::has_stepped(double x_s, double y_s) {
  if (x_s < last_x_s_ - kStep_s) return true;
  const double delay_s = y_s - line_s(x_s);
  if (delay_s < kStep_s) late_since_s_.reset();
  if (delay_s < -kStep_s) return true;
  if (delay_s < kStep_s) return false;
  if (!late_since_s_) late_since_s_ = x_s;
  return std::abs(x_s - *late_since_s_) > kLate_s;
}

void ClockMap::restart(std::int64_t sender_ns, Timestamp arrival) {
  buckets_.clear();
  late_since_s_.reset();
  first_sender_ns_ = sender_ns;
  first_arrival_ = arrival;
  offset_s_ = slope_ = 0;
  ++restarts_;
}

void ClockMap::add(double x_s, double y_s) {
  const auto index = static_cast<std::int64_t>(std::floor(x_s / kBucket_s));
  if (buckets_.empty() || index > buckets_.back().index) {
    buckets_.push_back({.index = index, .x_s = x_s, .y_s = y_s});
  }
  Bucket& bucket = buckets_.back();
  ++bucket.count;
  bucket.sum_x_s += x_s;
  bucket.sum_y_s += y_s;
  // reordered stamps of earlier intervals count, but the points of the hull ascend
  if (index == bucket.index && y_s < bucket.y_s) {
    bucket.x_s = x_s;
    bucket.y_s = y_s;
  }
  while (buckets_.front().index <= bucket.index - kBuckets) buckets_.pop_front();
}

ClockMap::Sums ClockMap::sums() const {
  Sums out;
  for (const Bucket& bucket : buckets_) {
    out.count += static_cast<double>(bucket.count);
    out.x_s += bucket.sum_x_s;
    out.y_s += bucket.sum_y_s;
  }
  return out;
}

// The hull's slopes ascend: the edge under the mean is the last one that begins before it. With a
// bounded slope the line supports the hull at another vertex, that of the smallest y - slope x.
void ClockMap::fit() {
  std::array<Point, kBuckets> hull;
  std::size_t size = 0;
  for (const Bucket& bucket : buckets_) {
    const Point point{bucket.x_s, bucket.y_s};
    while (size >= 2 && turn(hull[size - 2], hull[size - 1], point) <= 0) --size;
    hull[size++] = point;
  }
  const Sums all = sums();
  const double mean_x_s = all.x_s / all.count;
  slope_ = 0;
  for (std::size_t i = 0; i + 1 < size && (i == 0 || hull[i].x_s <= mean_x_s); ++i) {
    slope_ = (hull[i + 1].y_s - hull[i].y_s) / (hull[i + 1].x_s - hull[i].x_s);
  }
  slope_ = std::clamp(slope_, -kMaxSkew, kMaxSkew);
  offset_s_ = std::numeric_limits<double>::infinity();
  for (const Point& point : std::span(hull).first(size)) {
    offset_s_ = std::min(offset_s_, point.y_s - slope_ * point.x_s);
  }
}

}  // namespace stillkite
