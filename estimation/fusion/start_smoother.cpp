#include "estimation/fusion/start_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/trimmed_mean.hpp"
#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr std::array<std::size_t, 4> kStarts{16, 32, 64, 128};  // of so many frames
constexpr std::size_t kEnoughFrames = 32;    // of which one that is believed is the last
constexpr std::size_t kChosenFrames = 20;    // of them, for depths and way to be found in
constexpr std::size_t kSearchedPoints = 64;  // tell starts apart
constexpr int kMostSteps = 21;
constexpr int kFewestViews = 5;  // of a point, among the chosen frames
constexpr int kWeighings = 3;
constexpr double kSettled = 1;                  // squared length of a step, in sigmas
constexpr std::size_t kMostToldBetween = 2000;  // while nothing is seen
constexpr std::size_t kMostFrames = 400;        // the same

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
  const double turn_sigma = std::sqrt(filter.pose_covariance().bottomRightCorner<3, 3>().trace());
  return turn_sigma < most * way * upper_median(inverse_depths);
}

}  // namespace

// A filter that is told the start again, so far up to a frame.
struct StartSmoother::Retold {
  FusionFilter filter;
  std::vector<FeatureView> landmarks;  // as the anchor sees them
  std::vector<int> strays;
  StartLandmarks about;
  RigidTransform world_from_anchor;
  std::vector<RigidTransform> way;  // of the frames that were searched
  std::size_t seen_frames = 0;      // of these, those with views
  double growth = 1;                // of these views' covariance
  std::size_t frames = 0;
  bool has_landmarks = false;
};

StartSmoother::StartSmoother(const FusionConfig& config, const FusionStart& start)
    : config_(config), start_(start), frames_(config.relinearize_start ? 1 : 0) {}

StartSmoother::~StartSmoother() = default;
StartSmoother::StartSmoother(StartSmoother&& other) noexcept = default;
StartSmoother& StartSmoother::operator=(StartSmoother&& other) noexcept = default;

void StartSmoother::begin_frame() {
  if (frames_.empty()) return;
  if (frames_.size() >= kMostFrames) return forget();
  frames_.emplace_back();
}

void StartSmoother::remember(ToldFrame::Tell tell) {
  if (frames_.empty()) return;
  ToldFrame& frame = frames_.back();
  auto& told = frame.seen.empty() ? frame.before_views : frame.after_views;
  if (told.size() >= kMostToldBetween) return forget();
  told.push_back(std::move(tell));
}

void StartSmoother::take_anchor() {
  if (seen_frames_ > 0 || !candidates_.empty()) return forget();
  if (!frames_.empty()) anchor_ = frames_.size() - 1;
}

void StartSmoother::offer(const StartCandidate& candidate) {
  if (frames_.empty() || std::ssize(candidates_) >= 2 * config_.landmarks) return;
  const bool is_known = std::any_of(candidates_.begin(), candidates_.end(), [&](const auto& c) {
    return c.reference.feature == candidate.reference.feature;
  });
  if (!is_known) candidates_.push_back(candidate);
}

void StartSmoother::see(std::span<const FeatureView> seen) {
  if (frames_.empty()) return;
  ++seen_frames_;
  for (const FeatureView& view : seen) {
    const bool is_candidate =
        std::any_of(candidates_.begin(), candidates_.end(),
                    [&](const auto& c) { return c.reference.feature == view.feature; });
    if (is_candidate) frames_.back().seen.push_back(view);
  }
}

void StartSmoother::forget() {
  frames_.clear();
  candidates_.clear();
  search_.reset();
  retold_.reset();
}

std::unique_ptr<FusionFilter> StartSmoother::go_on(const std::vector<Landmark>& at_hand,
                                                   const std::vector<int>& given_up) {
  if (frames_.empty()) return nullptr;
  if (std::find(kStarts.begin(), kStarts.end(), seen_frames_) != kStarts.end()) {
    begin_search(at_hand, given_up);
    return nullptr;
  }
  if (search_ && step_all(*search_)) {
    if (!search_->estimates.empty()) begin_telling(*search_);
    search_.reset();
    if (!retold_ && seen_frames_ >= kStarts.back()) forget();
    return nullptr;
  }
  if (!retold_ || !tell_more(*retold_)) return nullptr;
  std::unique_ptr<FusionFilter> told;
  if (is_believed(retold_->filter, retold_->seen_frames)) {
    told = std::make_unique<FusionFilter>(std::move(retold_->filter));
  }
  const bool is_last = retold_->seen_frames >= (told ? kEnoughFrames : kStarts.back());
  retold_.reset();
  if (is_last) forget();
  return told;
}

// The nearest answer to the guesses is at times a false one, as is that of the filter itself, or of
// a longer way. What 16 frames tell may be one of these, and 32 from the guesses show it, or 64.
void StartSmoother::begin_search(const std::vector<Landmark>& at_hand,
                                 const std::vector<int>& given_up) {
  retold_.reset();
  std::erase_if(candidates_, [&](const StartCandidate& c) {
    return std::find(given_up.begin(), given_up.end(), c.reference.feature) != given_up.end();
  });
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!frames_[i].seen.empty()) seen.push_back(i);
  }
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(seen.size(), kChosenFrames);
  for (std::size_t i = 1; i <= count; ++i) chosen.push_back(seen[i * seen.size() / count - 1]);
  search_.emplace(
      Search{.seen_frames = seen_frames_,
             .bundle = StartBundle(config_, start_prior(config_, start_, frames_, anchor_, chosen),
                                   anchor_, frames_, chosen, candidates_),
             .estimates = {}});
  std::vector<double> guessed, known, found;
  for (std::size_t i = 0; i < std::min(candidates_.size(), kSearchedPoints); ++i) {
    const StartCandidate& candidate = candidates_[i];
    const auto landmark = std::find_if(at_hand.begin(), at_hand.end(), [&](const Landmark& l) {
      return l.feature == candidate.reference.feature;
    });
    guessed.push_back(candidate.guess);
    known.push_back(landmark == at_hand.end() ? candidate.guess : landmark->inverse_depth);
    const auto before = found_.find(candidate.reference.feature);
    found.push_back(before == found_.end() ? candidate.guess : before->second.inverse_depth);
  }
  search_->estimates = {search_->bundle.begin(guessed), search_->bundle.begin(known)};
  if (!found_.empty()) search_->estimates.push_back(search_->bundle.begin(found));
}

// True once one is left that has settled with all points, weighed, or none.
bool StartSmoother::step_all(Search& search) const {
  constexpr int kStepsAtOnce = 4;
  const auto has_settled = [](const StartEstimate& e) { return e.step < kSettled; };
  const auto has_failed = [](const StartEstimate& e) { return !std::isfinite(e.cost); };
  for (int i = 0; i < kStepsAtOnce; ++i) {
    for (StartEstimate& estimate : search.estimates) {
      if (!has_settled(estimate)) search.bundle.step(estimate);
    }
    std::erase_if(search.estimates, has_failed);
    if (++search.steps >= kMostSteps) std::erase_if(search.estimates, std::not_fn(has_settled));
    if (search.estimates.empty()) return true;
    if (!std::all_of(search.estimates.begin(), search.estimates.end(), has_settled)) continue;
    if (search.weighings == kWeighings) return true;
    // the likeliest goes on, then weighed by what its points were off by before
    StartEstimate likeliest =
        std::move(*std::min_element(search.estimates.begin(), search.estimates.end(),
                                    [](const auto& a, const auto& b) { return a.cost < b.cost; }));
    if (!search.bundle.add_rest(likeliest)) {
      search.bundle.weigh(likeliest);
      ++search.weighings;
    }
    likeliest.step = HUGE_VAL;
    search.estimates.assign(1, std::move(likeliest));
    search.steps = 0;
  }
  return false;
}

// Points that stray are no landmarks, and others that were not at hand take their places. What a
// few frames see, from about one place, is off alike in all of them, and what stays was chosen
// because it agrees.
void StartSmoother::begin_telling(const Search& search) {
  const StartEstimate& found = search.estimates.front();
  FusionConfig config = config_;
  config.inverse_depth_sigma_ratio *= kVagueness;
  config.relinearize_start = false;
  config.depth_correlated_frames = 0;
  retold_ = std::make_unique<Retold>(Retold{.filter = FusionFilter(config, start_),
                                            .landmarks = {},
                                            .strays = {},
                                            .about = {},
                                            .world_from_anchor = search.bundle.world_from_anchor(),
                                            .way = search.bundle.way(found),
                                            .seen_frames = search.seen_frames});
  std::vector<FeatureView>& landmarks = retold_->landmarks;
  found_.clear();
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    const StartEstimate::Point& point = found.points[i];
    const FeatureView& reference = search.bundle.candidates()[i].reference;
    found_[reference.feature] = {point.inverse_depth, point.stray};
    if (point.views < kFewestViews) continue;
    if (point.stray.value() > config.stray_above_ratio) {
      retold_->strays.push_back(reference.feature);
    } else {
      landmarks.push_back(reference);
    }
  }
  retold_->about = found_;
  if (search.seen_frames < kEnoughFrames && !landmarks.empty()) {
    const auto strays = static_cast<double>(retold_->strays.size());
    retold_->growth =
        trimmed_mean_growth(strays / (strays + static_cast<double>(landmarks.size())));
    for (FeatureView& landmark : landmarks) landmark.covariance *= retold_->growth;
  }
  if (std::ssize(landmarks) > config.landmarks) {
    landmarks.erase(landmarks.begin() + config.landmarks, landmarks.end());
  }
  if (2 * std::ssize(landmarks) <
      std::min<std::ptrdiff_t>(config.landmarks, std::ssize(candidates_))) {
    retold_.reset();
  }
}

// True once it has been told all, up to now: what came since the search as what will come.
bool StartSmoother::tell_more(Retold& again) const {
  constexpr double kToldAtOnce = 5;
  constexpr double kAsNew = 5.0 / 3;  // gated, which takes longer
  for (double left = kToldAtOnce; left > 0 && again.frames < frames_.size(); ++again.frames) {
    const ToldFrame& frame = frames_[again.frames];
    for (const auto& tell : frame.before_views) tell(again.filter);
    if (!frame.seen.empty()) {
      left -= again.frames < again.way.size() ? 1 : kAsNew;
      if (!std::exchange(again.has_landmarks, true)) {
        for (const FeatureView& landmark : again.landmarks) again.filter.add_landmark(landmark);
        for (const int stray : again.strays) again.filter.give_up(stray);
      }
      if (again.frames < again.way.size()) {
        std::vector<FeatureView> seen = frame.seen;
        for (FeatureView& view : seen) view.covariance *= again.growth;
        again.filter.update_landmarks_about(again.about, again.world_from_anchor,
                                            again.way[again.frames], seen);
      } else {
        again.filter.update_landmarks(frame.seen);
      }
    }
    for (const auto& tell : frame.after_views) tell(again.filter);
  }
  return again.frames == frames_.size();
}

}  // namespace stillkite
