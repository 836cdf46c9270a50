#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>

#include "estimation/fusion/dense_update.hpp"
#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/landmark_depth.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr int kMostRefusals = 5;

}  // namespace

void FusionFilter::offer_landmark(const FeatureView& reference) {
  start_.offer({reference, guessed_inverse_depth(state_, reference.bearing,
                                                 height(state_.world_from_anchor.translation))});
}

// A depth that a view tells is known as well as that view will say. One that is guessed is wrong as
// others are: of a first map that is its scale, but later ones must not tell what lengths are.
void FusionFilter::add_landmark(const FeatureView& reference,
                                const std::optional<Eigen::Vector2d>& seen) {
  constexpr double kUntold_ratio = 3;
  offer_landmark(reference);
  if (static_cast<int>(landmarks_.size()) >= most_landmarks()) return;
  if (landmark_of(reference.feature)) return;
  const int column = size();
  const int depth = column + 2;
  const double guess = guessed_inverse_depth(state_, reference.bearing,
                                             height(state_.world_from_anchor.translation));
  std::optional<double> told;
  if (seen) told = triangulated_inverse_depth(state_, reference.bearing, *seen, guess);
  if (!told && !needs_guesses()) return;
  P_.block(column, 0, 3, column + 3).setZero();
  P_.block(0, column, column, 3).setZero();
  P_.block<2, 2>(column, column) = reference.covariance;
  const double sigma =
      told ? kUntold_ratio * std::max(*told, guess) : config_.inverse_depth_sigma_ratio * guess;
  P_(depth, depth) = square(sigma);
  if (!told && !is_first_map_) {
    P_(depth, depth) += square(sigma);
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      if (!landmarks_[i].is_guess) continue;
      const int other = Index::landmark(i) + 2;
      P_(other, depth) = P_(depth, other) =
          sigma * config_.inverse_depth_sigma_ratio * landmarks_[i].inverse_depth;
    }
  }
  const auto first = std::count_if(landmarks_.begin(), landmarks_.end(),
                                   [](const Landmark& l) { return !l.is_spare; });
  landmarks_.push_back({.feature = reference.feature,
                        .bearing = reference.bearing,
                        .reference = reference.bearing,
                        .inverse_depth = told ? *told : guess,
                        .is_guess = !told,
                        .is_spare = first >= config_.landmarks});
}

// Those of the map before carry the camera until views tell the new ones' depths.
bool FusionFilter::needs_guesses() const {
  const auto known = std::count_if(landmarks_.begin(), landmarks_.end(),
                                   [](const Landmark& l) { return l.unseen == 0 && !l.is_guess; });
  return is_first_map_ || known < config_.min_landmarks;
}

int FusionFilter::update_landmarks(std::span<const FeatureView> seen) {
  age_windows(seen);
  std::vector<LandmarkView> views = landmark_views(seen);
  for (Landmark& landmark : landmarks_) {
    landmark.is_guess = false;
    ++landmark.unseen;
  }
  for (const LandmarkView& view : views) landmarks_[view.landmark].unseen = 0;
  const bool is_corrected = correct_by(views);
  if (is_corrected) {
    blame_strays(views);
    start_.see(seen);
  }
  drop_refused();
  if (is_corrected) {
    if (const std::unique_ptr<FusionFilter> again = start_.go_on(landmarks_, dropped_)) {
      adopt(*again);
    }
  }
  settle_unit();
  return is_corrected ? static_cast<int>(views.size()) : 0;
}

// By those that agree with where the camera should be. Where a third do not, but most do once one
// thing is doubted, that is wrong: the gyroscope's bias has jumped; or the camera has leapt, for
// images are missing whose time has not passed.
bool FusionFilter::correct_by(std::vector<LandmarkView>& views) {
  const std::vector<LandmarkView> all = views;
  const auto are_few = [&](const std::vector<LandmarkView>& agreed) {
    return 3 * agreed.size() < 2 * all.size();
  };
  std::optional<JointCorrection> correction = agreeing(views);
  std::vector<LandmarkView> agreed = views;  // also where that are too few
  if (!correction) views.clear();
  const auto is_explained_by = [&](auto&& doubt) {
    doubt(1);
    std::vector<LandmarkView> others = all;
    std::optional<JointCorrection> other = agreeing(others);
    const bool is_explained = other && !are_few(others);
    if (is_explained) {
      correction = std::move(other);
      views = agreed = std::move(others);
    } else {
      doubt(-1);
    }
    return is_explained;
  };
  if (are_few(views) && static_cast<int>(all.size()) >= config_.min_landmarks) {
    const bool is_gyro = gyro_s_ > 0 && is_explained_by([this](int sign) { doubt_gyro(sign); });
    has_leapt_ =
        !is_gyro && is_explained_by([this](int sign) { inflate_position_covariance(sign); });
  }
  count_refusals(all, agreed);
  if (!correction) return false;
  subtract_gram(correction->A_t, P_);
  inject(correction->error);
  return true;
}

// Those that agree are in the order of all.
void FusionFilter::count_refusals(const std::vector<LandmarkView>& all,
                                  const std::vector<LandmarkView>& agreed) {
  auto next = agreed.begin();
  for (const LandmarkView& view : all) {
    if (next != agreed.end() && next->landmark == view.landmark) {
      ++next;
    } else {
      ++landmarks_[view.landmark].refused;
    }
  }
}

// What lies where things at two depths meet moves as no point does, a little: it stays within what
// the filter is told of a view, but not within what most views of the frame are off by. It counts
// for less, and is refused where it is off by much. Where depths are vague they take up nearly all;
// none is refused for less than it is told.
void FusionFilter::blame_strays(const std::vector<LandmarkView>& views) {
  constexpr double kMost = 6.25;  // per degree of freedom: beyond it are two of a thousand
  const ViewErrors errors = view_errors(state_, landmarks_, views);
  const double most = kMost * std::max(errors.usual, 1.0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    Landmark& landmark = landmarks_[views[i].landmark];
    const int depth = Index::landmark(views[i].landmark) + 2;
    const bool is_behind =
        landmark.inverse_depth < 0 && square(landmark.inverse_depth) > 4 * P_(depth, depth);
    landmark.stray.add(errors.squared[i] / errors.usual);
    landmark.refused = errors.squared[i] > most || is_behind ? landmark.refused + 1 : 0;
  }
}

std::optional<std::size_t> FusionFilter::landmark_of(int feature) const {
  const auto found = std::find_if(landmarks_.begin(), landmarks_.end(),
                                  [&](const Landmark& l) { return l.feature == feature; });
  if (found == landmarks_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - landmarks_.begin());
}

bool FusionFilter::is_within_gate(const LandmarkView& view) const {
  const auto innovation =
      landmark_innovation(state_, landmarks_[view.landmark], Index::landmark(view.landmark),
                          view.bearing, view.covariance);
  if (!innovation) return false;
  const Eigen::Matrix2d S = innovation->H.covariance(P_) + innovation->noise;
  return innovation->residual.dot(S.llt().solve(innovation->residual)) <=
         2 * square(config_.gate_sigma);
}

// Over the last step, and from now on; a jump is none of what a data sheet says of the bias. The
// sign: -1 takes it back.
void FusionFilter::doubt_gyro(int sign) {
  constexpr double kJump_rad_s = 0.02;
  constexpr int r = Index::kRotation;
  constexpr int b = Index::kGyroBias;
  const double variance = sign * square(kJump_rad_s);
  const Eigen::Matrix3d turn_by_bias =
      -gyro_s_ * state_.world_from_camera.rotation.toRotationMatrix();
  P_.diagonal().segment<3>(b).array() += variance;
  P_.diagonal().segment<3>(r).array() += square(gyro_s_) * variance;
  P_.block<3, 3>(r, b) += variance * turn_by_bias;
  P_.block<3, 3>(b, r) += variance * turn_by_bias.transpose();
}

// What it leaps by tells nothing of its speed, which is in doubt as well where no accelerometer
// tells it.
void FusionFilter::inflate_position_covariance(int sign) {
  constexpr double kAnySpeed_heights_s = 2;
  const double speed = kAnySpeed_heights_s * height(state_.world_from_camera.translation);
  const double variance = sign * square(speed);
  P_.diagonal().segment<3>(Index::kPosition).array() += square(step_s_) * variance;
  if (has_accel_) return;
  P_.diagonal().segment<3>(Index::kVelocity).array() += variance;
}

// Without those that the gate refuses or that contradict the rest, one by one; where half of these
// would have to go none is believed.
std::optional<JointCorrection> FusionFilter::agreeing(std::vector<LandmarkView>& views) const {
  std::erase_if(views, [&](const LandmarkView& view) { return !is_within_gate(view); });
  if (views.empty()) return std::nullopt;
  const std::size_t fewest = views.size() / 2;
  std::optional<JointCorrection> correction = joint_correction(state_, landmarks_, P_, views);
  while (correction) {
    const std::optional<std::size_t> outlier = outlier_among(*correction, config_.gate_sigma);
    if (!outlier) break;
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(*outlier));
    if (views.size() <= fewest) return std::nullopt;
    correction = joint_correction(state_, landmarks_, P_, views);
  }
  return correction;
}

void FusionFilter::drop_refused() {
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    if (landmarks_[i].refused >= kMostRefusals) give_up(landmarks_[i].feature);
  }
}

void FusionFilter::give_up(int feature) {
  if (std::find(dropped_.begin(), dropped_.end(), feature) == dropped_.end()) {
    dropped_.push_back(feature);
  }
  if (const std::optional<std::size_t> i = landmark_of(feature)) remove_landmark(*i);
}

void FusionFilter::drop_unseen(bool keep_first) {
  constexpr int kForgottenAfter = 15;
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    const bool is_kept = keep_first && !landmarks_[i].is_spare;
    if (landmarks_[i].unseen >= kForgottenAfter && !is_kept) remove_landmark(i);
  }
}

void FusionFilter::remove_landmark(std::size_t i) {
  const int n = size();
  const int column = Index::kLandmarks + 3 * static_cast<int>(i);
  const int after = n - column - 3;
  P_.block(column, 0, after, n) = P_.block(column + 3, 0, after, n).eval();
  P_.block(0, column, n, after) = P_.block(0, column + 3, n, after).eval();
  landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace stillkite
