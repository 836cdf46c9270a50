#pragma once

#include <string>
#include <vector>

#include "app/page_state.hpp"

namespace stillkite {

/// Verdict in words, for an operator.
[[nodiscard]] const char* verdict_words(Verdict verdict);

/// Reason to withhold commands in words, for an operator.
[[nodiscard]] const char* reason_words(HoldReason reason);

/// Conditions that an operator must know, one sentence each, the most important first.
[[nodiscard]] std::vector<std::string> flight_alarms(const PageState& state, Timestamp now);

}  // namespace stillkite
