#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluation/evaluation.hpp"

namespace stillkite {

/// `evaluation` of summary.json; unavailable figures are null.
[[nodiscard]] nlohmann::json evaluation_json(const Evaluation& evaluation);

}  // namespace stillkite
