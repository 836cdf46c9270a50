#include "estimation/start_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "estimation/fusion_filter.hpp"

namespace stillkite {
namespace {

constexpr std::array<std::size_t, 4> kStarts{20, 40, 80, 160};  // of so many frames
constexpr std::size_t kEnoughFrames = 40;  // of which one that is believed is the last
constexpr int kMostPasses = 21;
constexpr int kWeighings = 3;
constexpr int kSearched = 32;  // landmarks, and half as many spare ones, tell false starts
constexpr std::size_t kMostToldBetween = 2000;  // while nothing is seen

// Where the way is short for the noise, what it turns the landmarks by may as well be a turn, and
// the likeliest start is off by more than its covariance tells. To be believed the turn must be
// known to a share of the angle under which the landmark of median depth sees the way.
bool is_believed(const FusionFilter& filter, std::size_t frames) {
  const double most = frames < kEnoughFrames ? 0.05 : 0.12;
  const FusionState& state = filter.state();
  const double way =
      (state.world_from_camera.translation - state.world_from_anchor.translation).norm();
  std::vector<double> inverse_depths;
  for (const Landmark& landmark : filter.landmarks()) {
    inverse_depths.push_back(landmark.inverse_depth);
  }
  if (inverse_depths.empty()) return false;  // all given up meanwhile
  const auto middle = inverse_depths.begin() + inverse_depths.size() / 2;
  std::nth_element(inverse_depths.begin(), middle, inverse_depths.end());
  const double turn_sigma = std::sqrt(filter.pose_covariance().bottomRightCorner<3, 3>().trace());
  return turn_sigma < most * way * *middle;
}

}  // namespace

// told the same again, up to a frame
struct StartSmoother::Pass {
  FusionFilter filter;
  std::size_t frames = 0;
  double cost = 0;  // of the views -2 log likelihood, but for what all starts share
};

struct StartSmoother::Passes {
  StartLandmarks about = {};
  StartWay way = {};  // that goes with these depths; empty: each frame's resection
  int weighings = 0;
  int done = 0;
  bool is_settled = false;
  bool is_last = false;            // then it takes the place of what is at hand
  std::optional<Pass> begun = {};  // the one at hand, if there is one
  // what the last one told
  double cost = HUGE_VAL;
  std::vector<Landmark> landmarks = {};
  // among starts, without weights
  [[nodiscard]] bool is_search() const { return weighings == 0; }
  [[nodiscard]] bool is_over() const { return is_settled || done >= weighings + kMostPasses; }
};

StartSmoother::StartSmoother(const FusionConfig& config, const FusionStart& start)
    : config_(config), start_(start), told_(config.relinearize_start ? 1 : 0) {}

StartSmoother::~StartSmoother() = default;
StartSmoother::StartSmoother(const StartSmoother& other) = default;
StartSmoother::StartSmoother(StartSmoother&& other) noexcept = default;
StartSmoother& StartSmoother::operator=(const StartSmoother& other) = default;
StartSmoother& StartSmoother::operator=(StartSmoother&& other) noexcept = default;

void StartSmoother::remember(std::function<void(FusionFilter&)> told) {
  if (told_.empty()) return;
  if (told_.back().told.size() >= kMostToldBetween) return forget();
  told_.back().told.push_back(std::move(told));
}

void StartSmoother::close_frame(std::span<const FeatureView> seen,
                                const std::vector<int>& believed) {
  if (told_.empty()) return;
  for (const int feature : believed) {
    told_.back().seen.push_back(*std::find_if(
        seen.begin(), seen.end(), [&](const FeatureView& v) { return v.feature == feature; }));
  }
  told_.emplace_back();
}

void StartSmoother::forget() {
  told_.clear();
  passes_.clear();
}

// The nearest answer to the guesses is at times a false one, as is that of the filter itself, or of
// a longer way. What 20 frames tell may be one of these, and 40 from the guesses show it, or 80.
// Passes that have not settled yet go on.
void StartSmoother::begin(const std::vector<Landmark>& at_hand) {
  passes_frames_ = told_.size() - 1;
  std::vector<Passes> starts{Passes{}, passes_about(at_hand, passes_frames_)};
  for (Passes& passes : passes_) starts.push_back(Passes{.about = std::move(passes.about)});
  for (Passes& start : starts) {
    for (auto& [feature, landmark] : start.about) landmark.stray = {};
  }
  passes_ = std::move(starts);
}

std::unique_ptr<FusionFilter> StartSmoother::go_on(const std::vector<Landmark>& at_hand) {
  if (told_.empty()) return nullptr;
  const std::size_t frames = told_.size() - 1;
  if (std::find(kStarts.begin(), kStarts.end(), frames) != kStarts.end()) begin(at_hand);
  if (passes_.empty()) return nullptr;
  // 1. So many pictures a frame, of one start after the other: more would take too long.
  constexpr std::size_t kSearchedAtOnce = 80;
  constexpr std::size_t kRetoldAtOnce = 20;
  std::size_t left = passes_.front().is_search() ? kSearchedAtOnce : kRetoldAtOnce;
  for (Passes& passes : passes_) {
    if (passes.is_over() || left == 0) continue;
    if (retell(passes, passes.is_last ? frames : passes_frames_, left)) judge(passes);
  }
  if (!std::all_of(passes_.begin(), passes_.end(), [](const Passes& p) { return p.is_over(); })) {
    return nullptr;
  }
  // 2. The likeliest goes on with weights, and then takes the place of what is at hand.
  Passes best = std::move(
      *std::min_element(passes_.begin(), passes_.end(),
                        [](const Passes& a, const Passes& b) { return a.cost < b.cost; }));
  passes_.clear();
  if (best.is_settled && !best.is_last) {
    const bool is_weighed = !best.is_search();
    passes_.push_back(passes_about(best.landmarks, is_weighed ? frames : passes_frames_));
    passes_.back().weighings = kWeighings;
    passes_.back().is_last = is_weighed;
    return nullptr;
  }
  std::unique_ptr<FusionFilter> told;
  if (best.is_last && is_believed(best.begun->filter, passes_frames_)) {
    told = std::make_unique<FusionFilter>(std::move(best.begun->filter));
  }
  if (passes_frames_ >= (told ? kEnoughFrames : kStarts.back())) forget();
  return told;
}

StartSmoother::Passes StartSmoother::passes_about(const std::vector<Landmark>& landmarks,
                                                  std::size_t frames) const {
  Passes passes{.way = way_about(landmarks, frames)};
  for (const Landmark& l : landmarks) passes.about[l.feature] = {l.inverse_depth, l.stray};
  return passes;
}

// Passes about each frame's resection itself, noisy as one frame is, are pulled by that noise,
// which is the views' own, and settle slowly or elsewhere.
StartWay StartSmoother::way_about(const std::vector<Landmark>& landmarks,
                                  std::size_t frames) const {
  return smoothed_way(config_, start_, std::span(told_).first(frames), landmarks);
}

// Tells a new filter some more frames, as many as are left, linearised about depths and a way;
// where no depth is given yet about the guess, which is then given. True once it has been told them
// all.
bool StartSmoother::retell(Passes& passes, std::size_t frames, std::size_t& left) const {
  if (!passes.begun) {
    FusionConfig config = config_;
    config.relinearize_start = false;
    config.depth_correlated_frames = 0;
    if (passes.is_search()) config.landmarks = std::min(config.landmarks, kSearched);
    passes.begun = Pass{.filter = FusionFilter(config, start_)};
  }
  Pass& again = *passes.begun;
  for (; left > 0 && again.frames < frames; --left, ++again.frames) {
    const ToldFrame& frame = told_[again.frames];
    for (const auto& tell : frame.told) tell(again.filter);
    for (const Landmark& landmark : again.filter.landmarks()) {
      passes.about.try_emplace(landmark.feature, StartLandmark{landmark.inverse_depth, {}});
    }
    const bool has_pose = again.frames < passes.way.size();
    if (passes.is_last && !has_pose) {
      again.filter.update_landmarks(frame.seen);  // what came since, as what will come
    } else {
      again.cost += again.filter.update_landmarks_about(
          passes.about, has_pose ? &passes.way[again.frames] : nullptr, frame.seen);
    }
  }
  return again.frames == frames;
}

// Settled once no depth moves, where all are in view. In the first passes, as many as `weighings`,
// each landmark is weighed by what its views were off by in the one before.
void StartSmoother::judge(Passes& passes) const {
  constexpr double kSettled_sigma = 0.1;
  passes.is_settled = passes.is_last;
  if (passes.is_last) return;
  const Pass again = *std::exchange(passes.begun, std::nullopt);
  passes.cost = again.cost;
  passes.landmarks = again.filter.landmarks();
  passes.way = way_about(passes.landmarks, passes_frames_);
  const bool weighs = passes.done++ < passes.weighings;
  passes.is_settled = std::isfinite(again.cost) && !weighs;
  for (std::size_t i = 0; i < passes.landmarks.size(); ++i) {
    const Landmark& landmark = passes.landmarks[i];
    StartLandmark& before = passes.about[landmark.feature];
    if (std::abs(landmark.inverse_depth - before.inverse_depth) >=
        kSettled_sigma * again.filter.inverse_depth_sigma(i)) {
      passes.is_settled = false;
    }
    before.inverse_depth = landmark.inverse_depth;
    if (weighs) before.stray = landmark.stray;
  }
}

}  // namespace stillkite
