#pragma once

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// Mallows weights of a bounded-influence estimator (Hampel et al. 1986, "Robust statistics",
/// section 6.3): pairs with a leverage h = g^T N^-1 g above four times the mean are downweighted.
/// g = de / d(w, u), N = weighted sum of g g^T.
///
/// With little relief, rotation and direction are correlated: a common change hardly moves the
/// epipolar lines of inliers, but strongly those of outliers. An outlier near its epipolar line
/// then outweighs hundreds of inliers and creates a local minimum.
[[nodiscard]] BearingColumns with_bounded_leverage(BearingColumns columns, const RelativePose& pose,
                                                   double cutoff);

}  // namespace stillkite
