#include "navigation/landmark_selection.hpp"

#include <algorithm>

namespace stillkite {
namespace {

// Variance ratio of a distortion model error at the pair to that on the optical axis: the error
// grows at least with the squared distance from the axis.
double distortion_factor(const BearingPair& pair) {
  constexpr double kReferenceRadius = 0.5;  // on z = 1
  const double mean_square = 0.5 * (pair.reference.squaredNorm() + pair.current.squaredNorm());
  return 1 + square(mean_square / square(kReferenceRadius));
}

}  // namespace

void LandmarkSelection::add_unit_variance(std::optional<double> unit_variance) {
  constexpr double kMinVariance = 0.25;  // video coding may repeat an image with its noise
  last_ = unit_variance.value_or(0);
  if (unit_variance) mean_.add(std::max(*unit_variance, kMinVariance));
}

double LandmarkSelection::unit_variance() const {
  return last_ > RunningRatio::kMost ? last_ : mean_.value();
}

std::vector<FeatureView> LandmarkSelection::views(const FeatureBearings& bearings,
                                                  const std::vector<unsigned char>& inliers) const {
  std::vector<FeatureView> out;
  out.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < std::min(bearings.pairs.size(), inliers.size()); ++i) {
    if (inliers[i] == 0) continue;
    out.push_back({.feature = static_cast<int>(bearings.feature_of_pair[i]),
                   .bearing = bearings.pairs[i].current,
                   .covariance = covariance(bearings, i, unit_variance())});
  }
  return out;
}

void LandmarkSelection::select(FusionFilter& filter, const FeatureBearings& bearings,
                               const std::vector<unsigned char>& inliers,
                               bool on_first_reference) const {
  if (!bearings.pairs.empty()) associate(filter, bearings);
  std::vector<unsigned char> candidates = inliers;
  const std::vector<int>& removed = filter.dropped();
  for (std::size_t i = 0; i < std::min(candidates.size(), bearings.pairs.size()); ++i) {
    const int feature = static_cast<int>(bearings.feature_of_pair[i]);
    if (std::find(removed.begin(), removed.end(), feature) != removed.end()) candidates[i] = 0;
  }
  if (std::find(candidates.begin(), candidates.end(), 1) == candidates.end()) return;
  // candidates that replace outliers
  constexpr std::size_t kOfferedFactor = 2;
  const auto count = static_cast<std::size_t>(landmarks_to_add(filter, on_first_reference));
  const bool is_first_selection = filter.landmarks().empty();
  std::vector<Eigen::Vector2d> existing;
  existing.reserve(filter.landmarks().size());
  for (const Landmark& landmark : filter.landmarks()) existing.push_back(landmark.bearing);
  const std::vector<std::size_t> selected = select_spread_pairs(
      bearings.pairs, candidates, existing, is_first_selection ? kOfferedFactor * count : count);
  for (std::size_t k = 0; k < selected.size(); ++k) {
    const FeatureView reference = in_reference(bearings, selected[k]);
    if (k < count) {
      filter.add_landmark(reference, bearings.pairs[selected[k]].current);
    } else {
      filter.offer_landmark(reference);
    }
  }
}

// A feature tracked into the next reference agrees to a pixel: patches lie on whole pixels.
void LandmarkSelection::associate(FusionFilter& filter, const FeatureBearings& bearings) const {
  constexpr double kSamePoint_px = 1;
  std::vector<FeatureView> reference;
  reference.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    reference.push_back(in_reference(bearings, i));
  }
  filter.number_landmarks(reference, kSamePoint_px / focal_px_);
}

int LandmarkSelection::landmarks_to_add(FusionFilter& filter, bool on_first_reference) const {
  const std::vector<Landmark>& landmarks = filter.landmarks();
  const auto in_view = static_cast<int>(std::count_if(
      landmarks.begin(), landmarks.end(), [](const Landmark& l) { return l.unseen == 0; }));
  const int min_in_view = config_.landmarks / 2;
  if (in_view < min_in_view) filter.drop_unseen(on_first_reference);
  return std::max(
      {0, config_.landmarks - static_cast<int>(landmarks.size()), min_in_view - in_view});
}

FeatureView LandmarkSelection::in_reference(const FeatureBearings& bearings,
                                            std::size_t pair) const {
  return {.feature = static_cast<int>(bearings.feature_of_pair[pair]),
          .bearing = bearings.pairs[pair].reference,
          .covariance = covariance(bearings, pair, mean_.value())};
}

// Measurement noise on z = 1. Image noise and coding raise the unit variance independently per
// feature. The excess comes from calibration or time errors, correlated between landmarks, so its
// variance is scaled with their number: more of them carry no more information.
Eigen::Matrix2d LandmarkSelection::covariance(const FeatureBearings& bearings, std::size_t pair,
                                              double unit_variance) const {
  constexpr double kDefaultSigma_px = 0.1;
  constexpr double kIndependentVariance = 4;
  constexpr double kMaxCodingVariance = 12;  // upper bound, first images of a video
  constexpr double kCorrelatedLandmarks = 48;
  const double one_px = 1 / focal_px_;
  const Eigen::Matrix2d noise =
      bearings.covariance.empty()
          ? (square(kDefaultSigma_px * one_px) * Eigen::Matrix2d::Identity()).eval()
          : bearings.covariance[pair];
  const double correlated =
      std::max(0.0, std::min(unit_variance, kMaxCodingVariance) - kIndependentVariance) +
      std::max(0.0, unit_variance - kMaxCodingVariance) * distortion_factor(bearings.pairs[pair]);
  const double total = std::min(unit_variance, kIndependentVariance) +
                       correlated * std::max(1.0, config_.landmarks / kCorrelatedLandmarks);
  return square(config_.pixel_sigma_px * one_px) * Eigen::Matrix2d::Identity() +
         square(config_.pixel_noise_ratio) * total * noise;
}

}  // namespace stillkite
