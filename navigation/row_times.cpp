#include "navigation/row_times.hpp"

#include "geometry/row_time.hpp"

namespace stillkite {

void RowTimes::begin(Timestamp reference_stamp) {
  reference_stamp_ = reference_stamp;
  features_.clear();
}

FeatureBearings RowTimes::at_stamp(const FeatureBearings& bearings, const FeatureTracks& tracks,
                                   Timestamp stamp) {
  if (readout_s_ == 0) return bearings;
  constexpr double kLongest_s = 0.15;  // a speed is the mean over no longer
  features_.resize(tracks.reference_px.size());
  FeatureBearings out;
  out.pairs.reserve(bearings.pairs.size());
  out.feature_of_pair.reserve(bearings.pairs.size());
  const double stamp_s = seconds_between(reference_stamp_, stamp);
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    const std::size_t f = bearings.feature_of_pair[i];
    const BearingPair& pair = bearings.pairs[i];
    Feature& feature = features_[f];
    const double reference_later_s = row_time_s(readout_s_, tracks.reference_px[f].y(), height_px_);
    const double current_later_s = row_time_s(readout_s_, tracks.current_px[f].y(), height_px_);
    if (feature.views == 0) feature = {1, reference_later_s, pair.reference, std::nullopt};
    const double since_s = stamp_s + current_later_s - feature.exposure_s;
    const Eigen::Vector2d speed_1_s = (pair.current - feature.seen) / since_s;
    const bool is_speed = since_s > 0 && since_s < kLongest_s;
    if (is_speed && feature.views == 1) {
      feature.reference = pair.reference - reference_later_s * speed_1_s;
    }
    ++feature.views;
    feature.exposure_s = stamp_s + current_later_s;
    feature.seen = pair.current;
    if (!is_speed || !feature.reference) continue;
    out.pairs.push_back({*feature.reference, pair.current - current_later_s * speed_1_s});
    out.feature_of_pair.push_back(f);
    if (!bearings.covariance.empty()) out.covariance.push_back(bearings.covariance[i]);
  }
  return out;
}

}  // namespace stillkite
