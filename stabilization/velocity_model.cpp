#include "stabilization/velocity_model.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

void VelocityModel::advance(Timestamp now) {
  Instant next{now};
  if (count_ > 0) {
    const Instant& last = past_[(count_ - 1) % kInstants];
    const double dt_s = seconds_between(last.stamp, now);
    if (!(dt_s > 0)) return;
    // closed form of w' = (u - w) / lag and of its integral
    const double response = lag_s_ > 0 ? -std::expm1(-dt_s / lag_s_) : 1;
    next.displacement =
        last.displacement + command_ * dt_s + (rate_ - command_) * (lag_s_ * response);
    rate_ += (command_ - rate_) * response;
    next.rate = rate_;
  }
  past_[count_ % kInstants] = next;
  ++count_;
}

TranslationYaw VelocityModel::displacement_since(Timestamp since) const {
  return count_ == 0 ? TranslationYaw::Zero()
                     : TranslationYaw(past_[(count_ - 1) % kInstants].displacement -
                                      at(since).displacement);
}

TranslationYaw VelocityModel::rate_at(Timestamp then) const {
  return at(then).rate;
}

VelocityModel::Instant VelocityModel::at(Timestamp then) const {
  if (count_ == 0) return {};
  const std::size_t kept = std::min(count_, kInstants);
  const Instant* later = &past_[(count_ - 1) % kInstants];
  for (std::size_t back = 1; back <= kept; ++back) {
    const Instant& here = past_[(count_ - back) % kInstants];
    if (here.stamp <= then) {
      const double between_s = seconds_between(here.stamp, later->stamp);
      const double ratio =
          between_s > 0 ? std::min(1.0, seconds_between(here.stamp, then) / between_s) : 0.0;
      return {then, here.displacement + ratio * (later->displacement - here.displacement),
              here.rate + ratio * (later->rate - here.rate)};
    }
    later = &here;
  }
  return *later;
}

}  // namespace stillkite
