#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillkite {

/// Positions of the reference features in the current image, in the order of the reference.
struct FeatureTracks {
  std::vector<Eigen::Vector2f> reference_px;
  std::vector<Eigen::Vector2f> current_px;
  std::vector<unsigned char> found;  ///< 1 where `current_px` is valid
  /// Covariance of `current_px` from the patch residual under white pixel noise. Optimistic after
  /// JPEG: errors are 1 to 1.6 sigma (bench_feature_error). Empty if the method has no covariance.
  std::vector<Eigen::Matrix2f> covariance_px2;
  int found_count = 0;
};

}  // namespace stillkite
