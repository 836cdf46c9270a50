#pragma once

#include <optional>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/running_ratio.hpp"
#include "navigation/feature_bearings.hpp"

namespace stillkite {

/// Which of the reference's features are the fusion's landmarks, and how well each is seen.
class LandmarkChoice {
 public:
  LandmarkChoice(const FusionConfig& config, double focal_px)
      : config_(config), focal_px_(focal_px) {}

  /// What a frame's features are off by, squared, over what their covariances say.
  void weigh(std::optional<double> unit_variance);
  /// The mean of it, or of a frame that is off by far its own.
  [[nodiscard]] double unit_variance() const;
  /// Those of the reference before go on under this one's numbers, and others are added where too
  /// few are in view. At home, which will be met again, none that is out of view makes way.
  void choose(FusionFilter& filter, const FeatureBearings& bearings,
              const std::vector<unsigned char>& inliers, bool on_first_reference) const;
  /// The inliers, where they are seen now.
  [[nodiscard]] std::vector<FeatureView> views(const FeatureBearings& bearings,
                                               const std::vector<unsigned char>& inliers) const;

 private:
  void number(FusionFilter& filter, const FeatureBearings& bearings) const;
  // How many may come.
  [[nodiscard]] int make_room(FusionFilter& filter, bool on_first_reference) const;
  [[nodiscard]] FeatureView in_reference(const FeatureBearings& bearings, std::size_t pair) const;
  [[nodiscard]] Eigen::Matrix2d covariance(const FeatureBearings& bearings, std::size_t pair,
                                           double unit_variance) const;

  FusionConfig config_;
  double focal_px_;
  RunningRatio mean_;  // of unit variances
  double last_ = 0;
};

}  // namespace stillkite
