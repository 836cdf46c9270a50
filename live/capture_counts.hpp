#pragma once

#include <cstdint>

namespace stillkite {

/// Numbers of images of a live video.
struct CaptureCounts {
  std::int64_t decoded = 0;
  std::int64_t replaced = 0;  ///< dropped: a newer one was decoded before the estimator was free
  std::int64_t rejected = 0;  ///< damaged, out of order, of another size, or while settling
  std::int64_t sessions = 0;  ///< openings of the source
};

}  // namespace stillkite
