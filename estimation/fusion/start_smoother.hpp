#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "estimation/fusion/start_bundle.hpp"

namespace stillkite {

/// What a frame's landmarks are linearised about.
struct StartLandmark {
  double inverse_depth = 0;
  RunningRatio stray;
};
using StartLandmarks = std::map<int, StartLandmark>;  // by features

/// Of a hover's first images way and depths are known together or not at all, and a filter
/// linearises each image about what it knew by then. Once a few are there, the depths and the way
/// are found that explain all of them (StartBundle), and all that the filter was told is told to
/// another one, linearised about these. Where the images may as well show a turn as a way, twice
/// as many are waited for.
class StartSmoother {
 public:
  /// Remembers nothing where `config.relinearize_start` is off.
  StartSmoother(const FusionConfig& config, const FusionStart& start);
  ~StartSmoother();
  StartSmoother(StartSmoother&& other) noexcept;
  StartSmoother& operator=(StartSmoother&& other) noexcept;

  void begin_frame();
  void remember(ToldFrame::Tell tell);
  /// The camera, here, is the anchor of the candidates to come. After those of another one nothing
  /// is remembered any more.
  void take_anchor();
  void offer(const StartCandidate& candidate);
  /// A frame's features, some of which have corrected the filter.
  void see(std::span<const FeatureView> seen);
  void forget();
  /// As much as one frame has time for, first about these landmarks, without the features that
  /// were given up. Once the start is known and can be no turn: a filter that has been told all,
  /// up to now.
  [[nodiscard]] std::unique_ptr<FusionFilter> go_on(const std::vector<Landmark>& at_hand,
                                                    const std::vector<int>& given_up);

 private:
  struct Search {
    std::size_t seen_frames;
    StartBundle bundle;
    std::vector<StartEstimate> estimates;  // one a start, then the likeliest
    int steps = 0;                         // of those that are there
    int weighings = 0;
  };
  struct Retold;
  void begin_search(const std::vector<Landmark>& at_hand, const std::vector<int>& given_up);
  [[nodiscard]] bool step_all(Search& search) const;
  void begin_telling(const Search& search);
  [[nodiscard]] bool tell_more(Retold& again) const;

  FusionConfig config_;
  FusionStart start_;
  std::vector<ToldFrame> frames_;  // since the start, the last one still open; empty: forgotten
  std::size_t anchor_ = 0;         // the frame in which it was taken
  std::vector<StartCandidate> candidates_;
  std::size_t seen_frames_ = 0;
  std::optional<Search> search_;
  StartLandmarks found_;  // by the last search
  std::unique_ptr<Retold> retold_;
};

}  // namespace stillkite
