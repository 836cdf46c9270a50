#pragma once

#include "estimation/verdict.hpp"
#include "navigation/navigator_config.hpp"

namespace stillkite {

/// Configuration that runs, with the keys that depend on other inputs. Idempotent; unchanged
/// unless the policy is fused:
/// - reference.renew_below_ratio and fusion.renew_below_ratio: the larger of both;
/// - without a metric scale of the initial state: fusion.depth_correlated_frames at least 300,
///   fusion.inverse_depth_sigma_ratio at most 0.5, fusion.relinearize_start false.
/// `Navigator` applies it; the command prints it.
[[nodiscard]] NavigatorConfig effective_config(NavigatorConfig config, Policy policy,
                                               ScaleSource initial_scale);

}  // namespace stillkite
