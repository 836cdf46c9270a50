#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

/// Answer to one question about the set-up of a flight.
enum class SetupVerdict { ok, doubtful, wrong, cannot_tell };
template <>
struct EnumNames<SetupVerdict> {
  static constexpr auto value = std::to_array<std::pair<SetupVerdict, std::string_view>>(
      {{SetupVerdict::ok, "ok"},
       {SetupVerdict::doubtful, "doubtful"},
       {SetupVerdict::wrong, "wrong"},
       {SetupVerdict::cannot_tell, "cannot tell"}});
};

/// Statistic behind a verdict. `bound`: limit between ok and not.
struct SetupMeasurement {
  double value = 0;
  std::optional<double> sigma;
  std::optional<double> bound;
  std::string_view unit;
};

struct SetupFinding {
  std::string question;
  SetupVerdict verdict = SetupVerdict::cannot_tell;
  std::string text;    ///< measured value and bound, or the reason why there is none
  std::string remedy;  ///< YAML of the configuration, or an action; empty if nothing is to be done
  std::optional<SetupMeasurement> measured;
};

using SetupFindings = std::vector<SetupFinding>;

/// The most severe verdict: wrong, doubtful, else ok.
[[nodiscard]] SetupVerdict worst_verdict(const SetupFindings& findings);

}  // namespace stillkite
