#include "stabilization/own_motion.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

void OwnMotion::advance(Timestamp now) {
  Instant next{now};
  if (count_ > 0) {
    const Instant& last = past_[(count_ - 1) % kInstants];
    const double dt_s = seconds_between(last.stamp, now);
    if (!(dt_s > 0)) return;
    // closed form of w' = (u - w) / lag and of its integral
    const double gone = lag_s_ > 0 ? -std::expm1(-dt_s / lag_s_) : 1;
    next.way = last.way + command_ * dt_s + (rate_ - command_) * (lag_s_ * gone);
    rate_ += (command_ - rate_) * gone;
  }
  past_[count_ % kInstants] = next;
  ++count_;
}

LevelMotion OwnMotion::way_since(Timestamp since) const {
  if (count_ == 0) return LevelMotion::Zero();
  const std::size_t kept = std::min(count_, kInstants);
  const Instant* later = &past_[(count_ - 1) % kInstants];
  const LevelMotion now = later->way;
  for (std::size_t back = 1; back <= kept; ++back) {
    const Instant& here = past_[(count_ - back) % kInstants];
    if (here.stamp <= since) {
      const double between_s = seconds_between(here.stamp, later->stamp);
      const double ratio =
          between_s > 0 ? std::min(1.0, seconds_between(here.stamp, since) / between_s) : 0.0;
      return now - here.way - ratio * (later->way - here.way);
    }
    later = &here;
  }
  return now - later->way;
}

}  // namespace stillkite
