#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr int kMostPasses = kLastFrames - kFirstFrames + 1;
constexpr int kWeighings = 2;
constexpr std::size_t kMostToldBetween = 2000;  // while nothing is seen

double log_determinant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

struct FusionFilter::Retold {
  FusionFilter filter;
  double cost = 0;  // -2 log likelihood of the views, but for what is the same for all starts
  std::map<int, RunningRatio> strays;
};

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
  // 1. A pass a frame; all of them together would take as long as several frames.
  std::vector<Retold> retold;
  for (StartPasses& passes : passes_) retold.push_back(next_pass(passes));
  const bool is_over = std::all_of(passes_.begin(), passes_.end(), [](const StartPasses& p) {
    return p.is_settled || p.done >= p.weighings + kMostPasses;
  });
  if (!is_over) return;
  // 2. The best one goes on with weights, and then takes the place of what is at hand.
  const auto best =
      std::min_element(retold.begin(), retold.end(),
                       [](const Retold& a, const Retold& b) { return a.cost < b.cost; });
  const StartPasses& chosen = passes_[static_cast<std::size_t>(best - retold.begin())];
  const bool is_settled = chosen.is_settled;
  const bool is_weighed = chosen.weighings > 0;
  passes_.clear();
  if (is_settled) {
    const std::size_t known = is_weighed ? frames : passes_frames_;
    StartPasses next = passes_about(best->filter.landmarks_, known);
    if (is_weighed) {
      adopt(retold_about(next, frames).filter);
    } else {
      next.weighings = kWeighings;
      passes_ = {std::move(next)};
    }
  }
  if (passes_.empty() && frames >= kLastFrames) forget_start();
}

FusionFilter::StartPasses FusionFilter::passes_about(const std::vector<Landmark>& landmarks,
                                                     std::size_t frames) const {
  StartPasses passes{.way = smoothed_way(landmarks, frames)};
  for (const Landmark& l : landmarks) passes.about[l.feature] = {l.inverse_depth, l.stray};
  return passes;
}

// Settled once no depth moves, where all are in view. In the first passes, as many as `weighings`,
// each landmark is weighed by what its views were off by in the one before.
FusionFilter::Retold FusionFilter::next_pass(StartPasses& passes) const {
  constexpr double kSettled_sigma = 0.1;
  Retold again = retold_about(passes, passes_frames_);
  passes.way = smoothed_way(again.filter.landmarks_, passes_frames_);
  const bool weighs = passes.done++ < passes.weighings;
  passes.is_settled = std::isfinite(again.cost) && !weighs;
  for (std::size_t i = 0; i < again.filter.landmarks_.size(); ++i) {
    const Landmark& landmark = again.filter.landmarks_[i];
    const int depth = column_of(i) + 2;
    StartLandmark& before = passes.about[landmark.feature];
    if (std::abs(landmark.inverse_depth - before.inverse_depth) >=
        kSettled_sigma * std::sqrt(again.filter.P_(depth, depth))) {
      passes.is_settled = false;
    }
    before.inverse_depth = landmark.inverse_depth;
    if (weighs) before.stray = landmark.stray;
  }
  return again;
}

// A filter that has been told the same up to a frame, linearised about depths and a way; where no
// depth is given yet about the guess, which is then given.
FusionFilter::Retold FusionFilter::retold_about(StartPasses& passes, std::size_t frames) const {
  FusionConfig config = config_;
  config.relinearize_start = false;
  config.depth_correlated_frames = 0;
  Retold again{.filter = FusionFilter(config, start_), .cost = 0, .strays = {}};
  for (std::size_t i = 0; i < frames; ++i) {
    for (const auto& tell : told_[i].told) tell(again.filter);
    const RigidTransform* pose = passes.way.empty() ? nullptr : &passes.way[i];
    again.filter.retell_views(told_[i].seen, pose, passes.about, again);
  }
  for (Landmark& landmark : again.filter.landmarks_) {
    landmark.stray = again.strays[landmark.feature];
  }
  return again;
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
    take_off(correction->A_t);
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
