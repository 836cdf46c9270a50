#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/time.hpp"
#include "navigation/feature_bearings.hpp"

namespace stillkite {

/// Features of a camera that exposes its rows one after the other, as they would have been seen at
/// the frame's stamp, which is its middle row's. How fast a feature moves in the image is what it
/// has moved since it was last seen, so that nothing need be known of the scene.
class RowTimes {
 public:
  /// `readout_s`: from the first row to the last; 0 leaves everything as it is.
  RowTimes(double readout_s, int height_px) : readout_s_(readout_s), height_px_(height_px) {}

  /// A new reference was taken: its features are seen there for the first time.
  void begin(Timestamp reference_stamp);
  /// Moves both bearings of the pairs. Those whose speed nobody saw, at the reference or now, are
  /// left out.
  [[nodiscard]] FeatureBearings at_stamp(const FeatureBearings& bearings,
                                         const FeatureTracks& tracks, Timestamp stamp);

 private:
  struct Feature {
    int views = 0;                             ///< that of the reference counts
    double exposure_s = 0;                     ///< of the last view, from the reference's stamp
    Eigen::Vector2d seen;                      ///< then
    std::optional<Eigen::Vector2d> reference;  ///< at the reference's stamp
  };

  double readout_s_;
  int height_px_;
  Timestamp reference_stamp_;
  std::vector<Feature> features_;
};

}  // namespace stillkite
