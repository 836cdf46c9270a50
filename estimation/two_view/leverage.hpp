#pragma once

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// The same pairs, those weighed down whose leverage h = g^T N^-1 g on the pose (g = de / d(w, u),
/// N the weighted sum of g g^T) exceeds four times the mean: Mallows' weights of a
/// bounded-influence estimator (Hampel et al. 1986, "Robust statistics", section 6.3).
///
/// Between two views of little relief, rotation and direction can turn together and hardly move the
/// epipolar lines at the true pairs, while they sweep over wrong pairs, which lie far from where
/// their neighbours went. A wrong pair that happens to be close to its line then outweighs hundreds
/// of true ones, and makes a false minimum wherever it does.
[[nodiscard]] BearingColumns with_bounded_leverage(BearingColumns columns, const RelativePose& pose,
                                                   double cutoff);

}  // namespace stillkite
