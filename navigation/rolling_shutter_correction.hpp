#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/time.hpp"
#include "navigation/feature_bearings.hpp"

namespace stillkite {

/// Rolling-shutter correction of features: bearings moved to the frame's stamp, the exposure of its
/// middle row. The image velocity of a feature is its displacement since its last observation, so
/// no scene depth is needed.
class RollingShutterCorrection {
 public:
  /// `readout_s`: readout time, first to last row; 0 (global shutter) changes nothing.
  RollingShutterCorrection(double readout_s, int height_px)
      : readout_s_(readout_s), height_px_(height_px) {}

  /// Resets the observations at a new reference frame.
  void begin(Timestamp reference_stamp);
  /// Corrects both bearings of each pair; removes pairs without an image velocity at either frame.
  [[nodiscard]] FeatureBearings at_stamp(const FeatureBearings& bearings,
                                         const FeatureTracks& tracks, Timestamp stamp);

 private:
  struct Feature {
    int views = 0;                             ///< observations, including the reference
    double exposure_s = 0;                     ///< of the last one, from the reference's stamp
    Eigen::Vector2d bearing;                   ///< bearing of the last one
    std::optional<Eigen::Vector2d> reference;  ///< bearing at the reference's stamp
  };

  double readout_s_;
  int height_px_;
  Timestamp reference_stamp_;
  std::vector<Feature> features_;
};

}  // namespace stillkite
