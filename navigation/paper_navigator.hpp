#pragma once

#include <vector>

#include "estimation/ego_motion/kalman_filter.hpp"
#include "estimation/ego_motion/least_squares.hpp"
#include "flow/flow_window_sampler.hpp"
#include "flow/pyramid.hpp"
#include "navigation/dense_flow.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/sensor_update.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// The flow paper's mode: its procedure of section 4, steps 1 to 7, a frame pair at a time
/// (docs/estimation_paper.md has what is as printed and what is not).
class PaperNavigator {
 public:
  /// Throws InputError on a value of the flow's configuration that is out of range.
  PaperNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                 const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// Of the last frame; empty where no flow was found. An outlier misses the one motion by more
  /// than `least_squares.inlier_px`, whatever weight it had.
  [[nodiscard]] std::vector<WindowFlow> windows() const;

 private:
  NavigationEstimate start(const Frame& frame, const SensorReadings& readings);
  [[nodiscard]] EgoMotion measure(const Frame& frame, const FrameInterval& interval,
                                  const SensorReadings& readings);
  void filter(const EgoMotion& motion, const SensorReadings& readings, double dt_s);
  void integrate(const EgoMotion& motion, const SensorReadings& readings, double dt_s);
  void forget_speed();
  void correct(const SensorReadings& readings, Timestamp now);
  [[nodiscard]] Vector6d velocities() const;
  [[nodiscard]] Twist twist_half_way() const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, const EgoMotion& motion) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  DenseFlow flow_;
  FlowWindowSampler sampler_;
  EgoMotionSolver solver_;

  Pyramid texture_;
  cv::Mat previous_;                 // shared with the source
  AxisEstimates axes_;               // the paper's vector V with its variances
  ScaledPose track_;                 // of the camera
  RigidTransform world_from_start_;  // of the camera, in the unit of `track_`
  RigidTransform before_;            // the camera at the frame before
  double blind_s_ = 0;               // since the last measurement
  double flow_ms_ = 0;
  double solve_ms_ = 0;
  std::vector<FlowWindow> windows_;
  EgoMotion motion_;
  double dt_s_ = 0;
};

}  // namespace stillkite
