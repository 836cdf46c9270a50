#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "estimation/start_way.hpp"

namespace stillkite {

/// What a start is gone through again about.
struct StartLandmark {
  double inverse_depth = 0;
  RunningRatio stray;
};
using StartLandmarks = std::map<int, StartLandmark>;  // by features

/// Of a hover's first pictures way and depths are known together or not at all, and a filter
/// linearises each picture about what it knew by then. Once a few are there, all that the filter
/// was told is gone through again about the depths and the poses that they tell as a whole, until
/// these stay: Gauss and Newton's steps on the whole start (iterated Kalman smoother: Bell 1994).
/// Where they may as well show a turn as a way, twice as many are waited for.
class StartSmoother {
 public:
  /// Remembers nothing where `config.relinearize_start` is off.
  StartSmoother(const FusionConfig& config, const FusionStart& start);
  ~StartSmoother();
  StartSmoother(const StartSmoother& other);
  StartSmoother(StartSmoother&& other) noexcept;
  StartSmoother& operator=(const StartSmoother& other);
  StartSmoother& operator=(StartSmoother&& other) noexcept;

  void remember(std::function<void(FusionFilter&)> told);
  /// The frame is over; of its views those of these features were believed.
  void close_frame(std::span<const FeatureView> seen, const std::vector<int>& believed);
  void forget();
  /// Goes through so many pictures again as one frame has time for, first about these landmarks.
  /// Once the passes have settled, and can be no turn: a filter that has been told all, up to now.
  [[nodiscard]] std::unique_ptr<FusionFilter> go_on(const std::vector<Landmark>& at_hand);

 private:
  struct Pass;
  struct Passes;
  void begin(const std::vector<Landmark>& at_hand);
  [[nodiscard]] Passes passes_about(const std::vector<Landmark>& landmarks,
                                    std::size_t frames) const;
  [[nodiscard]] StartWay way_about(const std::vector<Landmark>& landmarks,
                                   std::size_t frames) const;
  [[nodiscard]] bool retell(Passes& passes, std::size_t frames, std::size_t& left) const;
  void judge(Passes& passes) const;

  FusionConfig config_;
  FusionStart start_;
  std::vector<ToldFrame> told_;    // since the start, the last frame still open; empty: forgotten
  std::vector<Passes> passes_;     // those under way, one for each guess of the depths
  std::size_t passes_frames_ = 0;  // so much of what was told
};

}  // namespace stillkite
