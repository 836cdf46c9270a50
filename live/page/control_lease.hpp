#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Holder of the control, as seen by one operator.
enum class ControlHolder { nobody, this_operator, other_operator };
template <>
struct EnumNames<ControlHolder> {
  static constexpr auto value = std::to_array<std::pair<ControlHolder, std::string_view>>(
      {{ControlHolder::nobody, "nobody"},
       {ControlHolder::this_operator, "this_operator"},
       {ControlHolder::other_operator, "other_operator"}});
};

/// Control of at most one operator at a time. It ends when the operator returns it, or has been
/// silent for 10 s. Thread-safe.
class ControlLease {
 public:
  /// False if another operator has control.
  [[nodiscard]] bool take(const std::string& operator_id, Timestamp now);
  /// No effect if the operator has no control.
  void give_back(const std::string& operator_id);
  /// Current holder; renews the control of this operator.
  [[nodiscard]] ControlHolder renew(const std::string& operator_id, Timestamp now);

 private:
  [[nodiscard]] ControlHolder holder(const std::string& operator_id, Timestamp now) const;

  std::mutex mutex_;
  std::string operator_id_;         // of the last holder
  std::optional<Timestamp> heard_;  // last request of the holder; empty: nobody
};

}  // namespace stillkite
