#include <algorithm>
#include <cmath>
#include <iterator>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
// Of heights, as shares: what lies on one level differs by less, however little is known of it.
constexpr double kSameLevel = 0.04;

// d(up . way)/d(tilt)
Eigen::RowVector2d up_by_tilt(const Eigen::Vector3d& way) {
  return {-way.y(), way.x()};
}

// Map units.
double height_below_anchor(const FusionState& state, const Landmark& landmark) {
  const Eigen::Vector3d beside = state.world_from_anchor.rotation * landmark.bearing.homogeneous();
  return -up(state).dot(beside) / landmark.inverse_depth;
}

// d(-up . b / inverse_depth), times a factor, with b = R_a (bearing, 1).
SparseRows<1> height_row(const FusionState& state, const Landmark& landmark, int column,
                         double factor) {
  const Eigen::Vector3d u = up(state);
  const Eigen::Matrix3d R = state.world_from_anchor.rotation.toRotationMatrix();
  const double depth = 1 / landmark.inverse_depth;
  const Eigen::Vector3d to_landmark = depth * (R * landmark.bearing.homogeneous());
  SparseRows<1> row;
  row.add(Index::kTilt, -factor * up_by_tilt(to_landmark));
  row.add(Index::kAnchorRotation, factor * u.transpose() * skew(to_landmark));
  row.add(column, factor * depth *
                      Eigen::RowVector3d(-u.dot(R.col(0)), -u.dot(R.col(1)), u.dot(to_landmark)));
  return row;
}

// Below the anchor by its height, map units.
struct LowLandmark {
  std::size_t landmark = 0;
  double height = 0;
  double sigma_ratio = 0;  // against the one that is known best, as a share
  [[nodiscard]] bool is_known() const { return sigma_ratio <= 0.05; }
  // Things stand on the ground, none below it: what is known to lie over it does not belong to it.
  [[nodiscard]] double tolerance() const {
    constexpr double kLevel = 0.01;
    constexpr double kSigmas = 2;
    return std::min(kSameLevel, kLevel + kSigmas * sigma_ratio);
  }
};

bool is_on_level(const LowLandmark& low, double level, double tolerance) {
  return std::abs(low.height / level - 1) <= tolerance;
}

// The largest height on which several lie; that of their middle.
template <typename Tolerance>
std::optional<double> lowest_of(std::vector<LowLandmark> known, Tolerance&& tolerance) {
  constexpr std::size_t kSeveral = 5;
  std::sort(known.begin(), known.end(),
            [](const LowLandmark& a, const LowLandmark& b) { return a.height > b.height; });
  for (std::size_t first = 0; first + kSeveral <= known.size(); ++first) {
    const LowLandmark& highest = known[first + kSeveral - 1];
    if (is_on_level(highest, known[first].height, tolerance(highest))) {
      return known[first + kSeveral / 2].height;
    }
  }
  return std::nullopt;
}

// In a height what all landmarks share, as the way that all depths were learnt by, is of no
// matter to whether they lie on one level: each is compared with the one that is known best.
std::vector<LowLandmark> landmarks_below(const FusionState& state,
                                         const std::vector<Landmark>& landmarks,
                                         const Eigen::MatrixXd& P) {
  constexpr double kSteepness = 0.1;
  std::vector<LowLandmark> below;
  std::vector<SparseRows<1>> rows;
  std::vector<double> variances;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    if (!(landmark.inverse_depth > 0)) continue;
    const double height = height_below_anchor(state, landmark);
    if (height * landmark.inverse_depth < kSteepness) continue;
    below.push_back({.landmark = i, .height = height});
    rows.push_back(height_row(state, landmark, Index::landmark(i), 1 / height));
    variances.push_back(rows.back().covariance(P)(0, 0));
  }
  if (below.empty()) return below;
  const auto best = static_cast<std::size_t>(std::min_element(variances.begin(), variances.end()) -
                                             variances.begin());
  const Eigen::VectorXd with_best =
      rows[best].times_transposed(P, Index::landmark(landmarks.size()));
  for (std::size_t k = 0; k < below.size(); ++k) {
    const double difference = variances[k] + variances[best] - 2 * rows[k].times(with_best)(0, 0);
    below[k].sigma_ratio = std::sqrt(std::max(0.0, difference));
  }
  return below;
}

// The lowest on which several lie whose heights are known, unless others lie below it for certain:
// then it is a table, and the floor's are not yet known.
std::optional<double> ground_level(const std::vector<LowLandmark>& below) {
  constexpr double kSigmas = 2;
  constexpr int kStray = 1;
  std::vector<LowLandmark> known;
  std::copy_if(below.begin(), below.end(), std::back_inserter(known),
               [](const LowLandmark& low) { return low.is_known(); });
  const std::optional<double> level = lowest_of(known, [](auto&) { return kSameLevel; });
  if (!level) return std::nullopt;
  const auto lower = std::count_if(below.begin(), below.end(), [&](const LowLandmark& low) {
    return low.height / *level > 1 + kSameLevel + kSigmas * low.sigma_ratio;
  });
  if (lower > kStray) return std::nullopt;
  // rough ground has none on which they lie as well as they are known
  std::erase_if(known,
                [&](const LowLandmark& low) { return !is_on_level(low, *level, kSameLevel); });
  const std::optional<double> finer =
      lowest_of(known, [](const LowLandmark& low) { return low.tolerance(); });
  return finer ? finer : level;
}

// Of landmarks that are off, those that look lowest are chosen for the first ground: what they are
// off by is not independent, and as much the height over it is not known.
double doubt_of_level(const std::vector<LowLandmark>& on_level) {
  double variance = 0;
  for (const LowLandmark& low : on_level) {
    variance += square(low.sigma_ratio) / static_cast<double>(on_level.size());
  }
  return variance;
}

}  // namespace

// Of a place over the ground, map units: that of the start, as far as it is known, and the way up.
double FusionFilter::height(const Eigen::Vector3d& position) const {
  return start_in_world_.z() * std::exp(-(state_.log_scale + state_.log_height)) +
         up(state_).dot(position - start_in_world_);
}

double FusionFilter::height_m() const {
  return std::exp(state_.log_scale) * height(state_.world_from_camera.translation);
}

double FusionFilter::log_height_variance() const {
  return log_height_row().covariance(P_)(0, 0);
}

// Of ln(height_m()).
SparseRows<1> FusionFilter::log_height_row() const {
  const Eigen::Vector3d u = up(state_);
  const Eigen::Vector3d way = state_.world_from_camera.translation - start_in_world_;
  const double h = height(state_.world_from_camera.translation);
  const double from_start = 1 - u.dot(way) / h;
  SparseRows<1> row;
  row.add(Index::kPosition, u.transpose() / h);
  row.add(Index::kTilt, up_by_tilt(way) / h);
  row.add(Index::kScale, Eigen::RowVector2d(1 - from_start, -from_start));
  return row;
}

bool FusionFilter::shows_relief() const {
  constexpr std::size_t kFewest = 10;
  constexpr double kRelief = 0.1;
  constexpr double kSigmas = 3;
  std::vector<LowLandmark> known = landmarks_below(state_, landmarks_, P_);
  std::erase_if(known, [](const LowLandmark& low) { return !low.is_known(); });
  if (known.size() < kFewest) return false;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end(),
                   [](const auto& a, const auto& b) { return a.height < b.height; });
  const double level = middle->height;
  const auto off = std::count_if(known.begin(), known.end(), [&](const LowLandmark& low) {
    return std::abs(low.height / level - 1) > kRelief + kSigmas * low.sigma_ratio;
  });
  return 4 * off > std::ssize(known);
}

int FusionFilter::update_ground(bool is_flat) {
  // 1. Landmarks below the camera; where it is flat they are all on the ground, else those of the
  //    lowest level.
  std::vector<LowLandmark> ground = landmarks_below(state_, landmarks_, P_);
  bool is_first = false;
  double doubt = 0;
  if (!is_flat) {
    const std::optional<double> level = ground_level(ground);
    if (!level) return 0;
    std::erase_if(ground, [&](const LowLandmark& low) {
      return !low.is_known() || !is_on_level(low, *level, low.tolerance());
    });
    if (has_outgrown_its_scale()) forget_scale();
    is_first = std::none_of(landmarks_.begin(), landmarks_.end(),
                            [](const Landmark& l) { return l.is_on_ground; });
    if (is_first) doubt = doubt_of_level(ground);
  }
  // 2. So high the anchor is, by what is known of the start and the way since.
  P_(Index::kHeight, Index::kHeight) += doubt;
  int count = 0;
  for (const LowLandmark& low : ground) {
    Landmark& landmark = landmarks_[low.landmark];
    if (landmark.is_on_ground) continue;
    const auto innovation = ground_innovation(landmark, Index::landmark(low.landmark));
    landmark.is_on_ground = innovation && correct(*innovation);
    if (landmark.is_on_ground) ++count;
  }
  if (count == 0) P_(Index::kHeight, Index::kHeight) -= doubt;
  if (is_first && count > 0) told_scale_sigma_ = scale_sigma();
  return count;
}

// What vague depths told the scale follows them to first order only, and is off by a few percent
// once they are known much better. Where they were not much vaguer than the height at the start,
// telling it again would tell no more.
bool FusionFilter::has_outgrown_its_scale() const {
  constexpr double kMuchBetter = 0.5;
  if (!is_height_given_ || is_height_read_ || !told_scale_sigma_) return false;
  const double much_better = kMuchBetter * *told_scale_sigma_;
  return scale_sigma() < much_better && much_better > config_.height_sigma_ratio;
}

// As at the start, but for where it is; what lies on the ground may tell it again.
void FusionFilter::forget_scale() {
  const int n = size();
  P_.block<2, Eigen::Dynamic>(Index::kScale, 0, 2, n).setZero();
  P_.block<Eigen::Dynamic, 2>(0, Index::kScale, n, 2).setZero();
  P_(Index::kScale, Index::kScale) = square(config_.scale_sigma_ratio);
  add_height_variance(square(config_.height_sigma_ratio));
  state_.log_height = 0;
  for (Landmark& landmark : landmarks_) landmark.is_on_ground = false;
}

// The anchor's height is that of the way down to the landmark: with b = R_a (bearing, 1), in map
// units and in shares of the known height h0,
//   ln(h0 exp(-log_height - log_scale) + up . (p_a - p_0)) = ln(-up . b / inverse_depth)
// Of logarithms, in which a wrong unit, however wrong, is one sum: else the first landmark, where
// the scale is still wrong by half, would settle it beside where all others have it.
std::optional<Innovation<1>> FusionFilter::ground_innovation(const Landmark& landmark,
                                                             int column) const {
  using Row = Eigen::Matrix<double, 1, 1>;
  const Eigen::Vector3d u = up(state_);
  const Eigen::Vector3d way = state_.world_from_anchor.translation - start_in_world_;
  const double h = height(state_.world_from_anchor.translation);
  const double below = height_below_anchor(state_, landmark);
  if (!(h > 0 && below > 0)) return std::nullopt;
  const double from_start = 1 - u.dot(way) / h;
  Innovation<1> innovation{.residual = Row(std::log(h / below)),
                           .H = height_row(state_, landmark, column, 1 / below),
                           .noise = Row(square(config_.ground_sigma_ratio * from_start))};
  innovation.H.add(Index::kScale, Eigen::RowVector2d(from_start, from_start));
  innovation.H.add(Index::kTilt, -up_by_tilt(way) / h);
  innovation.H.add(Index::kAnchorPosition, -u.transpose() / h);
  return innovation;
}

// Of its logarithm, in which a wrong unit, however wrong, is one sum. In metres
//   h = h0 exp(-log_height) + exp(log_scale) up . (p - p_0)
bool FusionFilter::update_height(double height_m, double sigma_m) {
  start_.remember([=](FusionFilter& filter) { filter.update_height(height_m, sigma_m); });
  using Row = Eigen::Matrix<double, 1, 1>;
  const double expected_m = this->height_m();
  if (!(expected_m > 0 && height_m > 0)) return false;
  const Innovation<1> innovation{
      .residual = Row(std::log(height_m / expected_m)),
      .H = log_height_row(),
      .noise = Row(config_.height_correlated_frames * square(sigma_m / height_m))};
  if (!correct(innovation)) return false;
  is_height_read_ = true;
  if (!is_height_given_) start_m_.z() = start_in_world_.z() * std::exp(-state_.log_height);
  is_height_given_ = true;
  return true;
}

}  // namespace stillkite
