#include "navigation/landmark_choice.hpp"

#include <algorithm>

namespace stillkite {
namespace {

// A lens that is not as told errs by the square of the distance from its axis, or by more: of its
// variance so many times that on the axis.
double outwards(const BearingPair& pair) {
  constexpr double kWide = 0.5;  // on z = 1
  const double mean_square = 0.5 * (pair.reference.squaredNorm() + pair.current.squaredNorm());
  return 1 + square(mean_square / square(kWide));
}

}  // namespace

void LandmarkChoice::weigh(std::optional<double> unit_variance) {
  constexpr double kLeast = 0.25;  // coding may repeat a still image, noise and all
  last_ = unit_variance.value_or(0);
  if (unit_variance) mean_.add(std::max(*unit_variance, kLeast));
}

double LandmarkChoice::unit_variance() const {
  return last_ > RunningRatio::kMost ? last_ : mean_.value();
}

std::vector<FeatureView> LandmarkChoice::views(const FeatureBearings& bearings,
                                               const std::vector<unsigned char>& inliers) const {
  std::vector<FeatureView> seen;
  seen.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < std::min(bearings.pairs.size(), inliers.size()); ++i) {
    if (inliers[i] == 0) continue;
    seen.push_back({.feature = static_cast<int>(bearings.feature_of_pair[i]),
                    .bearing = bearings.pairs[i].current,
                    .covariance = covariance(bearings, i, unit_variance())});
  }
  return seen;
}

void LandmarkChoice::choose(FusionFilter& filter, const FeatureBearings& bearings,
                            const std::vector<unsigned char>& inliers,
                            bool on_first_reference) const {
  if (!bearings.pairs.empty()) number(filter, bearings);
  std::vector<unsigned char> usable = inliers;
  const std::vector<int>& dropped = filter.dropped();
  for (std::size_t i = 0; i < std::min(usable.size(), bearings.pairs.size()); ++i) {
    const int feature = static_cast<int>(bearings.feature_of_pair[i]);
    if (std::find(dropped.begin(), dropped.end(), feature) != dropped.end()) usable[i] = 0;
  }
  if (std::find(usable.begin(), usable.end(), 1) == usable.end()) return;
  // as many more as may take the places of those that stray
  constexpr std::size_t kOffered = 2;
  const auto count = static_cast<std::size_t>(make_room(filter, on_first_reference));
  const bool is_first_choice = filter.landmarks().empty();
  std::vector<Eigen::Vector2d> at_hand;
  at_hand.reserve(filter.landmarks().size());
  for (const Landmark& landmark : filter.landmarks()) at_hand.push_back(landmark.bearing);
  const std::vector<std::size_t> chosen =
      spread_pairs(bearings.pairs, usable, at_hand, is_first_choice ? kOffered * count : count);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const FeatureView reference = in_reference(bearings, chosen[k]);
    if (k < count) {
      filter.add_landmark(reference, bearings.pairs[chosen[k]].current);
    } else {
      filter.offer_landmark(reference);
    }
  }
}

// What is followed from one reference into the next is there to a pixel: windows lie on whole ones.
void LandmarkChoice::number(FusionFilter& filter, const FeatureBearings& bearings) const {
  constexpr double kSamePoint_px = 1;
  std::vector<FeatureView> reference;
  reference.reserve(bearings.pairs.size());
  for (std::size_t i = 0; i < bearings.pairs.size(); ++i) {
    reference.push_back(in_reference(bearings, i));
  }
  filter.number_landmarks(reference, kSamePoint_px / focal_px_);
}

int LandmarkChoice::make_room(FusionFilter& filter, bool on_first_reference) const {
  const std::vector<Landmark>& landmarks = filter.landmarks();
  const auto in_view = static_cast<int>(std::count_if(
      landmarks.begin(), landmarks.end(), [](const Landmark& l) { return l.unseen == 0; }));
  const int enough = config_.landmarks / 2;
  if (in_view < enough) filter.drop_unseen(on_first_reference);
  return std::max({0, config_.landmarks - static_cast<int>(landmarks.size()), enough - in_view});
}

FeatureView LandmarkChoice::in_reference(const FeatureBearings& bearings, std::size_t pair) const {
  return {.feature = static_cast<int>(bearings.feature_of_pair[pair]),
          .bearing = bearings.pairs[pair].reference,
          .covariance = covariance(bearings, pair, mean_.value())};
}

// On z = 1. Noise and coding make windows err a few times more than is told, each its own way. What
// exceeds that is a lens or a clock that is not as told, alike all around: from how many landmarks
// on more tell no more of it.
Eigen::Matrix2d LandmarkChoice::covariance(const FeatureBearings& bearings, std::size_t pair,
                                           double unit_variance) const {
  constexpr double kUntold_px = 0.1;
  constexpr double kOwn = 4;
  constexpr double kCoding = 12;  // a film's first images, at most
  constexpr double kEnough = 48;
  const double one_px = 1 / focal_px_;
  const Eigen::Matrix2d noise =
      bearings.covariance.empty()
          ? (square(kUntold_px * one_px) * Eigen::Matrix2d::Identity()).eval()
          : bearings.covariance[pair];
  const double alike = std::max(0.0, std::min(unit_variance, kCoding) - kOwn) +
                       std::max(0.0, unit_variance - kCoding) * outwards(bearings.pairs[pair]);
  const double once =
      std::min(unit_variance, kOwn) + alike * std::max(1.0, config_.landmarks / kEnough);
  return square(config_.pixel_sigma_px * one_px) * Eigen::Matrix2d::Identity() +
         square(config_.pixel_noise_ratio) * once * noise;
}

}  // namespace stillkite
