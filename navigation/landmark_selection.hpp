#pragma once

#include <optional>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/running_ratio.hpp"
#include "navigation/feature_bearings.hpp"

namespace stillkite {

/// Selects reference features as landmarks of the fusion and models their measurement noise.
class LandmarkSelection {
 public:
  LandmarkSelection(const FusionConfig& config, double focal_px)
      : config_(config), focal_px_(focal_px) {}

  /// Adds a frame's variance of unit weight (`stillkite::unit_variance`); empty: none measured.
  void add_unit_variance(std::optional<double> unit_variance);
  /// Running mean of the unit variances, or the last one if that is an outlier.
  [[nodiscard]] double unit_variance() const;
  /// Associates the landmarks with this reference's features and adds new ones where too few are
  /// in view. On the first reference, used for relocalization, none out of view is replaced.
  void select(FusionFilter& filter, const FeatureBearings& bearings,
              const std::vector<unsigned char>& inliers, bool on_first_reference) const;
  /// Measurements of the inliers in the current frame.
  [[nodiscard]] std::vector<FeatureView> views(const FeatureBearings& bearings,
                                               const std::vector<unsigned char>& inliers) const;

 private:
  void associate(FusionFilter& filter, const FeatureBearings& bearings) const;
  [[nodiscard]] int landmarks_to_add(FusionFilter& filter, bool on_first_reference) const;
  [[nodiscard]] FeatureView in_reference(const FeatureBearings& bearings, std::size_t pair) const;
  [[nodiscard]] Eigen::Matrix2d covariance(const FeatureBearings& bearings, std::size_t pair,
                                           double unit_variance) const;

  FusionConfig config_;
  double focal_px_;
  RunningRatio mean_;  // of the unit variances
  double last_ = 0;
};

}  // namespace stillkite
