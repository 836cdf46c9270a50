#pragma once

#include <optional>
#include <vector>

#include "estimation/plane/keyframe_view.hpp"
#include "estimation/plane/plane_alignment.hpp"
#include "flow/pyramid.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/pose_track.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// What a filter around the flow tells it.
struct FlowHints {
  bool may_search = true;  ///< the image for a lost keyframe, which takes several times as long
  std::optional<Eigen::Vector3d> normal;  ///< of the ground in the keyframe, for the view alone
};

/// The recommended mode: every image is aligned to a keyframe (docs/flow_navigator.md).
class KeyframeNavigator {
 public:
  KeyframeNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                    const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings, const FlowHints& hints = {});

  /// Of the last frame; empty where nothing was aligned.
  [[nodiscard]] std::vector<WindowFlow> windows() const;

  [[nodiscard]] bool has_leapt() const { return track_.has_leapt(); }

  /// What the last frame showed of the motion since the keyframe, before any filter, about a normal
  /// near enough to the one that was hinted at for first order; nothing where its verdict is not
  /// ok.
  [[nodiscard]] const std::optional<KeyframeView>& view() const { return view_; }

 private:
  NavigationEstimate start(const Frame& frame, const SensorReadings& readings);
  [[nodiscard]] PlaneAlignment align(bool may_search);
  [[nodiscard]] PlaneMotion predicted_motion() const;
  [[nodiscard]] bool is_prediction_vague() const;
  [[nodiscard]] std::vector<PlaneMotion> searched_motions() const;
  [[nodiscard]] bool fits(const PlaneAlignment& alignment) const;
  [[nodiscard]] bool is_better(const PlaneAlignment& a, const PlaneAlignment& b) const;
  [[nodiscard]] PlaneAlignment align_from(const PlaneMotion& guess);
  [[nodiscard]] bool learns_speed() const;
  [[nodiscard]] PlaneAlignment align_at_speed(const PlaneMotion& guess, const MotionFilter& speed);
  [[nodiscard]] KeyframeView view_of(const PlaneAlignment& alignment,
                                     const std::optional<Eigen::Vector3d>& normal);
  void remember_windows(const FrameInterval& interval);
  void for_each_window(auto&& visit) const;
  void tell_shift(double dt_s, NavigationEstimate& out) const;
  [[nodiscard]] Verdict judge(const PlaneAlignment& alignment) const;
  // True: a new keyframe is due.
  [[nodiscard]] bool count_success(const PlaneAlignment& alignment);
  [[nodiscard]] bool count_failure(Verdict verdict, const FrameInterval& interval);
  void take_keyframe();
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  PlaneAligner aligner_;
  PoseTrack track_;
  Pyramid current_;  // that of the keyframe is the aligner's
  std::optional<KeyframeView> view_;
  int windows_at_keyframe_ = 0;
  int aligned_ = 0;                                   // frames since the speed was unknown
  int failures_ = 0;                                  // frames in a row that did not align
  std::vector<float> previous_x_px_, previous_y_px_;  // the windows, before the last alignment
  bool keyframe_is_previous_ = false;
  bool has_windows_ = false;
};

}  // namespace stillkite
