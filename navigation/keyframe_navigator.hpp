#pragma once

#include <optional>
#include <vector>

#include "estimation/plane/keyframe_view.hpp"
#include "estimation/plane/plane_alignment.hpp"
#include "flow/pyramid.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/pose_track.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Inputs of an enclosing filter.
struct FlowHints {
  bool allow_search = true;  ///< search the image for a lost keyframe, several times an alignment
  std::optional<Eigen::Vector3d> normal = {};  ///< of the ground in the keyframe, for `view()` only
};

/// Recommended mode: every image is aligned to a keyframe (docs/plane_odometry.md).
class KeyframeNavigator {
 public:
  KeyframeNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                    const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings, const FlowHints& hints = {});

  /// Makes the last frame the keyframe.
  void take_keyframe();

  /// Flow of the tiles since the previous frame; empty if nothing was aligned.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

  /// True if the last frame's displacement is a discontinuity (PoseTrack).
  [[nodiscard]] bool has_jumped() const { return track_.has_jumped(); }

  /// Motion since the keyframe as measured in the last frame, unfiltered. It is linearized at a
  /// normal close to the hinted one. Empty unless the verdict is ok.
  [[nodiscard]] const std::optional<KeyframeView>& view() const { return view_; }

 private:
  NavigationEstimate initialize(const Frame& frame, const SensorReadings& readings);
  NavigationEstimate stand_still(const Frame& frame, const FrameInterval& interval,
                                 const SensorReadings& readings);
  void set_mask(const std::shared_ptr<const ImageMask>& mask);
  [[nodiscard]] PlaneAlignment align(bool allow_search);
  [[nodiscard]] PlaneMotion predicted_motion() const;
  [[nodiscard]] bool is_prediction_uncertain() const;
  [[nodiscard]] std::vector<PlaneMotion> search_hypotheses() const;
  [[nodiscard]] bool is_close_match(const PlaneAlignment& alignment) const;
  [[nodiscard]] bool is_better(const PlaneAlignment& a, const PlaneAlignment& b) const;
  [[nodiscard]] PlaneAlignment align_from(const PlaneMotion& initial);
  [[nodiscard]] bool is_speed_initializing() const;
  [[nodiscard]] PlaneAlignment align_with_velocity(const PlaneMotion& initial,
                                                   const MultipleModelFilter& velocity);
  [[nodiscard]] KeyframeView make_view(const PlaneAlignment& alignment);
  void store_tile_positions(const FrameInterval& interval);
  void for_each_tile(auto&& visit) const;
  void set_image_shift(NavigationEstimate& out) const;
  [[nodiscard]] SmoothErrors smooth_errors() const;
  [[nodiscard]] Verdict validate(const PlaneAlignment& alignment);
  [[nodiscard]] Verdict classify(const PlaneAlignment& alignment) const;
  void update_track(Verdict verdict, const PlaneAlignment& alignment,
                    const SensorReadings& readings, const Frame& frame,
                    const FrameInterval& interval);
  // true if this frame is the keyframe now
  bool renew_keyframe(Verdict verdict, const PlaneAlignment& alignment,
                      const FrameInterval& interval);
  // both return true if a new keyframe is needed
  [[nodiscard]] bool count_success(const PlaneAlignment& alignment);
  [[nodiscard]] bool count_failure(Verdict verdict, const FrameInterval& interval);
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  PlaneAligner aligner_;
  PoseTrack track_;
  ReliefFilter relief_;
  std::shared_ptr<const ImageMask> mask_;
  Pyramid current_;  // the keyframe's pyramid is held by the aligner
  FlowHints hints_;
  std::optional<KeyframeView> view_;
  std::optional<PlaneMotion> not_flat_motion_;  // of the last frame with this verdict
  int tiles_at_keyframe_ = 0;
  int frames_since_speed_reset_ = 0;
  int failures_ = 0;                                  // consecutive
  std::vector<float> previous_x_px_, previous_y_px_;  // tiles before the last alignment
  bool keyframe_is_previous_ = false;
  bool has_tiles_ = false;
};

}  // namespace stillkite
