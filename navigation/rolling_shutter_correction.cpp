#include "navigation/rolling_shutter_correction.hpp"

#include "geometry/camera.hpp"

namespace stillkite {

void RollingShutterCorrection::begin(Timestamp reference_stamp) {
  reference_stamp_ = reference_stamp;
  features_.clear();
}

FeatureBearings RollingShutterCorrection::at_stamp(const FeatureBearings& bearings,
                                                   const FeatureTracks& tracks, Timestamp stamp) {
  if (readout_s_ == 0) return bearings;
  constexpr double kMaxInterval_s = 0.15;  // maximum interval of an image velocity
  features_.resize(tracks.reference_px.size());
  FeatureBearings out;
  out.pairs.reserve(bearings.pairs.size());
  out.feature_of_pair.reserve(bearings.pairs.size());
  const double stamp_s = seconds_between(reference_stamp_, stamp);
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    const std::size_t f = bearings.feature_of_pair[i];
    const BearingPair& pair = bearings.pairs[i];
    Feature& feature = features_[f];
    const double reference_offset_s =
        row_time_offset_s(readout_s_, tracks.reference_px[f].y(), height_px_);
    const double current_offset_s =
        row_time_offset_s(readout_s_, tracks.current_px[f].y(), height_px_);
    if (feature.views == 0) feature = {1, reference_offset_s, pair.reference, std::nullopt};
    const double interval_s = stamp_s + current_offset_s - feature.exposure_s;
    const Eigen::Vector2d velocity_1_s = (pair.current - feature.bearing) / interval_s;
    const bool has_velocity = interval_s > 0 && interval_s < kMaxInterval_s;
    if (has_velocity && feature.views == 1) {
      feature.reference = pair.reference - reference_offset_s * velocity_1_s;
    }
    ++feature.views;
    feature.exposure_s = stamp_s + current_offset_s;
    feature.bearing = pair.current;
    if (!has_velocity || !feature.reference) continue;
    out.pairs.push_back({*feature.reference, pair.current - current_offset_s * velocity_1_s});
    out.feature_of_pair.push_back(f);
    if (!bearings.covariance.empty()) out.covariance.push_back(bearings.covariance[i]);
  }
  return out;
}

}  // namespace stillkite
