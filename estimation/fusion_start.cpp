#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/dense_update.hpp"
#include "estimation/fusion_filter.hpp"
#include "estimation/landmark_model.hpp"

// Of a hover's first pictures way and depths are known together or not at all, and a filter
// linearises each picture about what it knew by then. Once a few are there, all are gone through
// again about the depths and the poses that they tell as a whole, until these stay: Gauss and
// Newton's steps on the whole start (iterated Kalman smoother: Bell 1994). The poses are smoothed
// (fusion_start_way.cpp).
namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr std::size_t kFirstFrames = 20;
constexpr std::size_t kLastFrames = 40;
constexpr int kMostPasses = 21;
constexpr int kWeighings = 3;
constexpr int kSearched = 32;  // landmarks, and half as many spare ones, tell false starts
constexpr std::size_t kMostToldBetween = 2000;  // while nothing is seen

double log_determinant(const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

void FusionFilter::remember(std::function<void(FusionFilter&)> told) {
  if (told_.empty()) return;
  if (told_.back().told.size() >= kMostToldBetween) return forget_start();
  told_.back().told.push_back(std::move(told));
}

void FusionFilter::close_frame(std::span<const FeatureView> seen,
                               const std::vector<LandmarkView>& believed) {
  if (told_.empty()) return;
  for (const LandmarkView& view : believed) {
    const int feature = landmarks_[view.landmark].feature;
    const auto found = std::find_if(seen.begin(), seen.end(),
                                    [&](const FeatureView& v) { return v.feature == feature; });
    told_.back().seen.push_back(*found);
  }
  told_.emplace_back();
}

void FusionFilter::forget_start() {
  told_.clear();
  passes_.clear();
}

// The nearest answer to the guesses is at times a false one, as is that of the filter itself, or of
// a longer way. What 20 frames tell may be one of these, and 40 from the guesses show it. Passes
// that have not settled yet go on.
void FusionFilter::begin_passes(std::size_t frames) {
  passes_frames_ = frames;
  std::vector<StartPasses> starts{StartPasses{}, passes_about(landmarks_, frames)};
  for (StartPasses& passes : passes_) {
    starts.push_back(StartPasses{.about = std::move(passes.about)});
  }
  for (StartPasses& start : starts) {
    for (auto& [feature, landmark] : start.about) landmark.stray = {};
  }
  passes_ = std::move(starts);
}

void FusionFilter::relinearize_start() {
  if (told_.empty()) return;
  const std::size_t frames = told_.size() - 1;
  if (frames == kFirstFrames || frames == kLastFrames) begin_passes(frames);
  if (passes_.empty()) return;
  // 1. So many pictures a frame, of one start after the other: more would take too long.
  constexpr std::size_t kSearchedAtOnce = 80;
  constexpr std::size_t kRetoldAtOnce = 20;
  std::size_t left = passes_.front().is_search() ? kSearchedAtOnce : kRetoldAtOnce;
  const auto is_done = [](const StartPasses& p) {
    return p.is_settled || p.done >= p.weighings + kMostPasses;
  };
  for (StartPasses& passes : passes_) {
    if (is_done(passes) || left == 0) continue;
    if (retell(passes, passes.is_last ? frames : passes_frames_, left)) judge(passes);
  }
  if (!std::all_of(passes_.begin(), passes_.end(), is_done)) return;
  // 2. The best one goes on with weights, and then takes the place of what is at hand.
  const StartPasses best = std::move(*std::min_element(
      passes_.begin(), passes_.end(),
      [](const StartPasses& a, const StartPasses& b) { return a.cost < b.cost; }));
  passes_.clear();
  if (best.is_last) {
    adopt(best.begun->filter);
  } else if (best.is_settled) {
    const bool is_weighed = best.weighings > 0;
    passes_.push_back(passes_about(best.landmarks, is_weighed ? frames : passes_frames_));
    passes_.back().weighings = kWeighings;
    passes_.back().is_last = is_weighed;
    return;
  }
  if (frames >= kLastFrames) forget_start();
}

FusionFilter::StartPasses FusionFilter::passes_about(const std::vector<Landmark>& landmarks,
                                                     std::size_t frames) const {
  StartPasses passes{.way = smoothed_way(landmarks, frames)};
  for (const Landmark& l : landmarks) passes.about[l.feature] = {l.inverse_depth, l.stray};
  return passes;
}

// Settled once no depth moves, where all are in view. In the first passes, as many as `weighings`,
// each landmark is weighed by what its views were off by in the one before.
void FusionFilter::judge(StartPasses& passes) const {
  constexpr double kSettled_sigma = 0.1;
  passes.is_settled = passes.is_last;
  if (passes.is_last) return;
  const Retold again = *std::exchange(passes.begun, std::nullopt);
  passes.cost = again.cost;
  passes.landmarks = again.filter.landmarks_;
  passes.way = smoothed_way(passes.landmarks, passes_frames_);
  const bool weighs = passes.done++ < passes.weighings;
  passes.is_settled = std::isfinite(again.cost) && !weighs;
  for (std::size_t i = 0; i < passes.landmarks.size(); ++i) {
    const Landmark& landmark = passes.landmarks[i];
    const int depth = column_of(i) + 2;
    StartLandmark& before = passes.about[landmark.feature];
    if (std::abs(landmark.inverse_depth - before.inverse_depth) >=
        kSettled_sigma * std::sqrt(again.filter.P_(depth, depth))) {
      passes.is_settled = false;
    }
    before.inverse_depth = landmark.inverse_depth;
    if (weighs) before.stray = landmark.stray;
  }
}

// Tells a new filter some more frames, as many as are left, linearised about depths and a way;
// where no depth is given yet about the guess, which is then given. True once it has been told them
// all.
bool FusionFilter::retell(StartPasses& passes, std::size_t frames, std::size_t& left) const {
  if (!passes.begun) {
    FusionConfig config = config_;
    config.relinearize_start = false;
    config.depth_correlated_frames = 0;
    if (passes.is_search()) config.landmarks = std::min(config.landmarks, kSearched);
    passes.begun = Retold{.filter = FusionFilter(config, start_)};
  }
  Retold& again = *passes.begun;
  for (; left > 0 && again.frames < frames; --left, ++again.frames) {
    const ToldFrame& frame = told_[again.frames];
    for (const auto& tell : frame.told) tell(again.filter);
    const bool has_pose = again.frames < passes.way.size();
    again.filter.retell_views(frame.seen, has_pose ? &passes.way[again.frames] : nullptr,
                              passes.about, again);
  }
  if (again.frames < frames) return false;
  for (Landmark& landmark : again.filter.landmarks_) {
    landmark.stray = again.strays[landmark.feature];
  }
  return true;
}

// Adds what the views cost; infinite where one cannot be seen. Without the determinant a longer way
// would be the cheaper one, for views are told to err more the further away they are.
void FusionFilter::retell_views(std::span<const FeatureView> seen,
                                const RigidTransform* world_from_camera, StartLandmarks& about,
                                Retold& again) {
  const RigidTransform predicted = state_.world_from_camera;
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(size());
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    const StartLandmark& linear =
        about.try_emplace(landmark.feature, StartLandmark{landmark.inverse_depth, {}})
            .first->second;
    offset[column_of(i) + 2] = linear.inverse_depth - landmark.inverse_depth;
    landmark.inverse_depth = linear.inverse_depth;
    landmark.stray = linear.stray;
  }
  if (world_from_camera) {
    state_.world_from_camera = *world_from_camera;
  } else if (const std::optional<Resection> seen_from = resection(seen, landmarks_)) {
    state_.world_from_camera = seen_from->world_from_camera;
  }
  offset.segment<3>(Index::kRotation) =
      so3_log(state_.world_from_camera.rotation * predicted.rotation.conjugate());
  offset.segment<3>(Index::kPosition) =
      state_.world_from_camera.translation - predicted.translation;
  age_windows(seen);
  Eigen::VectorXd error = -offset;
  const std::vector<LandmarkView> views = landmark_views(seen);
  const auto correction = joint_correction(views, offset);
  if (correction) {
    subtract_gram(correction->A_t, P_);
    error += correction->error;
  }
  inject(error);
  again.cost += correction ? correction->squared + log_determinant(correction->S) : HUGE_VAL;
  const ViewErrors errors = view_errors(views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    again.strays[landmarks_[views[i].landmark].feature].add(errors.squared[i] / errors.usual);
  }
}

// Landmarks that have been given up meanwhile are left out. The ground is to be told again.
void FusionFilter::adopt(const FusionFilter& again) {
  std::vector<Landmark> at_hand = std::move(landmarks_);
  state_ = again.state_;
  P_ = again.P_;
  start_m_ = again.start_m_;
  is_height_given_ = again.is_height_given_;
  landmarks_ = again.landmarks_;
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    Landmark& landmark = landmarks_[i];
    const auto found = std::find_if(at_hand.begin(), at_hand.end(), [&](const Landmark& l) {
      return l.feature == landmark.feature;
    });
    if (found == at_hand.end()) {
      remove_landmark(i);
      continue;
    }
    landmark.is_guess = found->is_guess;
    landmark.is_spare = found->is_spare;
    landmark.refused = found->refused;
    landmark.unseen = found->unseen;
  }
}

}  // namespace stillkite
