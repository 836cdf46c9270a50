#include "navigation/effective_config.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

NavigatorConfig fused_config(double reference_ratio, double fusion_ratio) {
  NavigatorConfig config;
  config.reference.renew_below_ratio = reference_ratio;
  config.fusion.renew_below_ratio = fusion_ratio;
  return config;
}

TEST(EffectiveConfig, FusedRenewsTheReferenceAtTheLargerRatio) {
  const auto expect_ratio = [](const NavigatorConfig& given, double ratio) {
    const NavigatorConfig config =
        effective_config(given, Policy::fused, ScaleSource::initial_height);
    EXPECT_EQ(config.fusion.renew_below_ratio, ratio);
    EXPECT_EQ(config.reference.renew_below_ratio, ratio);
  };
  expect_ratio(fused_config(0, 0.3), 0.3);
  expect_ratio(fused_config(0.5, 0.3), 0.5);
}

TEST(EffectiveConfig, WithoutAScaleFusedCannotRelinearizeNorWidenDepths) {
  const FusionConfig fusion = effective_config({}, Policy::fused, ScaleSource::none).fusion;
  EXPECT_EQ(fusion.depth_correlated_frames, 300);
  EXPECT_EQ(fusion.inverse_depth_sigma_ratio, 0.5);
  EXPECT_FALSE(fusion.relinearize_start);
}

TEST(EffectiveConfig, KeepsStricterKeysWithoutAScale) {
  NavigatorConfig config;
  config.fusion.depth_correlated_frames = 400;
  config.fusion.inverse_depth_sigma_ratio = 0.2;
  const FusionConfig fusion = effective_config(config, Policy::fused, ScaleSource::none).fusion;
  EXPECT_EQ(fusion.depth_correlated_frames, 400);
  EXPECT_EQ(fusion.inverse_depth_sigma_ratio, 0.2);
}

TEST(EffectiveConfig, ChangesNothingForOtherPolicies) {
  for (const Policy policy : {Policy::flow, Policy::reference, Policy::best}) {
    const NavigatorConfig config =
        effective_config(fused_config(0.1, 0.3), policy, ScaleSource::none);
    EXPECT_EQ(config.reference.renew_below_ratio, 0.1);
    const FusionConfig& fusion = config.fusion;
    EXPECT_EQ(fusion.renew_below_ratio, 0.3);
    EXPECT_EQ(fusion.depth_correlated_frames, FusionConfig{}.depth_correlated_frames);
    EXPECT_EQ(fusion.inverse_depth_sigma_ratio, FusionConfig{}.inverse_depth_sigma_ratio);
    EXPECT_TRUE(fusion.relinearize_start);
  }
}

}  // namespace
}  // namespace stillkite
