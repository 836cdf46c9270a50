#include "navigation/effective_config.hpp"

#include <algorithm>

namespace stillkite {

NavigatorConfig effective_config(NavigatorConfig config, Policy policy, ScaleSource initial_scale) {
  if (policy != Policy::fused) return config;
  FusionConfig& fusion = config.fusion;
  double& reference_ratio = config.reference.renew_below_ratio;
  reference_ratio = std::max(fusion.renew_below_ratio, reference_ratio);
  fusion.renew_below_ratio = reference_ratio;
  if (initial_scale != ScaleSource::none) return config;
  // Without a height prior the scale converges from the IMU alone, and not from depths as uncertain
  // as the default. Relinearized about an unknown height the covariance is optimistic.
  constexpr double kMaxDepthSigma_ratio = 0.5;
  fusion.depth_correlated_frames = std::max(fusion.depth_correlated_frames, kCarefulFrames);
  fusion.inverse_depth_sigma_ratio =
      std::min(fusion.inverse_depth_sigma_ratio, kMaxDepthSigma_ratio);
  fusion.relinearize_start = false;
  return config;
}

}  // namespace stillkite
