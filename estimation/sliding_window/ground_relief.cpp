#include "estimation/sliding_window/ground_relief.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

// Before any point is known: a scene as uneven as a room with furniture.
constexpr double kInitialSigma_ratio = 0.2;
constexpr double kInitialShare = 0.5;
// Weight of these, in points.
constexpr double kPriorPoints = 5;
constexpr double kMinSigma_ratio = 1e-4;
// Of a plane: the scale that it gives is then as good as a height given to the same ratio.
constexpr double kMaxPlaneSigma_ratio = 0.02;

double normal_density(double x, double variance) {
  return std::exp(-0.5 * x * x / variance) / std::sqrt(variance);
}

}  // namespace

GroundRelief::GroundRelief(double camera_height_m)
    : spread_m_(camera_height_m),
      sigma_m_(kInitialSigma_ratio * camera_height_m),
      share_(kInitialShare),
      variance_sigma_m2_(sigma_m_ * sigma_m_) {}

bool GroundRelief::is_plane() const {
  return sigma_m_ < kMaxPlaneSigma_ratio * spread_m_;
}

bool GroundRelief::is_rough() const {
  const double max_m = kMaxPlaneSigma_ratio * spread_m_;
  return sigma_m_ * sigma_m_ - 2 * variance_sigma_m2_ > max_m * max_m;
}

double GroundRelief::probability(const PointHeight& point) const {
  const double ground =
      share_ * normal_density(point.height_m, sigma_m_ * sigma_m_ + point.variance_m2);
  const double other =
      (1 - share_) * normal_density(point.height_m, spread_m_ * spread_m_ + point.variance_m2);
  return ground > 0 ? ground / (ground + other) : 0;
}

void GroundRelief::add(const PointHeight& point, Sums& sums) const {
  const double probability = this->probability(point);
  const double variance = sigma_m_ * sigma_m_ + point.variance_m2;
  const double information = probability / (variance * variance);
  sums.probability += probability;
  sums.points += 1;
  sums.excess += information * (point.height_m * point.height_m - point.variance_m2);
  sums.information += information;
}

void GroundRelief::add(const PointHeight& point) {
  add(point, present_);
}

void GroundRelief::keep(const PointHeight& point) {
  add(point, kept_);
}

void GroundRelief::update() {
  const double initial_m2 = kInitialSigma_ratio * kInitialSigma_ratio * spread_m_ * spread_m_;
  const double initial_information = 1 / (initial_m2 * initial_m2);
  const double excess = initial_information * initial_m2 + kept_.excess + present_.excess;
  const double information = initial_information + kept_.information + present_.information;
  const double min_m = kMinSigma_ratio * spread_m_;
  sigma_m_ = std::sqrt(std::max(min_m * min_m, excess / information));
  variance_sigma_m2_ = std::sqrt(2 / information);
  share_ = (kPriorPoints * kInitialShare + kept_.probability + present_.probability) /
           (kPriorPoints + kept_.points + present_.points);
}

}  // namespace stillkite
