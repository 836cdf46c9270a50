#include "live/page/control_lease.hpp"

namespace stillkite {

ControlHolder ControlLease::holder(const std::string& operator_id, Timestamp now) const {
  constexpr double kMaxSilence_s = 10;
  if (!heard_ || seconds_between(*heard_, now) > kMaxSilence_s) return ControlHolder::nobody;
  return operator_id == operator_id_ ? ControlHolder::this_operator : ControlHolder::other_operator;
}

bool ControlLease::take(const std::string& operator_id, Timestamp now) {
  const std::lock_guard lock(mutex_);
  if (holder(operator_id, now) == ControlHolder::other_operator) return false;
  operator_id_ = operator_id;
  heard_ = now;
  return true;
}

void ControlLease::give_back(const std::string& operator_id) {
  const std::lock_guard lock(mutex_);
  if (operator_id == operator_id_) heard_.reset();
}

ControlHolder ControlLease::renew(const std::string& operator_id, Timestamp now) {
  const std::lock_guard lock(mutex_);
  const ControlHolder out = holder(operator_id, now);
  if (out == ControlHolder::this_operator) heard_ = now;
  return out;
}

}  // namespace stillkite
