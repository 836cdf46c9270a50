#pragma once

#include <vector>

#include "estimation/ego_motion/kalman_filter.hpp"
#include "estimation/ego_motion/least_squares.hpp"
#include "flow/flow_sampler.hpp"
#include "flow/pyramid.hpp"
#include "navigation/dense_flow.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/sensor_update.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Mode paper: the flow paper's procedure, section 4, steps 1 to 7, for each frame pair
/// (docs/plane_odometry.md lists the deviations).
class PaperNavigator {
 public:
  /// Throws InputError if a value of the flow's configuration is out of range.
  PaperNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                 const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// Flow vectors of the last frame; empty without flow. Weight 0 (outlier): residual above
  /// `least_squares.inlier_px`, whatever the solver's weight.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

 private:
  NavigationEstimate initialize(const Frame& frame, const SensorReadings& readings);
  [[nodiscard]] EgoMotion measure(const Frame& frame, const FrameInterval& interval,
                                  const SensorReadings& readings);
  void filter(const EgoMotion& motion, const SensorReadings& readings, double dt_s);
  void integrate(const EgoMotion& motion, const SensorReadings& readings, double dt_s);
  void reset_twist();
  void correct(const SensorReadings& readings, Timestamp now);
  [[nodiscard]] Vector6d velocities() const;
  [[nodiscard]] Twist mid_interval_twist() const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, const EgoMotion& motion) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  DenseFlow flow_;
  FlowSampler sampler_;
  EgoMotionSolver solver_;

  Pyramid texture_;
  cv::Mat previous_;                   // shared with the source
  AxisEstimates axes_;                 // the paper's vector V with its variances
  ScaledPose track_;                   // of the camera
  RigidTransform world_from_initial_;  // camera at the first frame, in the scale of `track_`
  RigidTransform before_;              // camera at the previous frame
  double unmeasured_s_ = 0;            // since the last measurement
  double flow_ms_ = 0;
  double solve_ms_ = 0;
  std::vector<FlowVector> vectors_;
  EgoMotion motion_;
  double dt_s_ = 0;
};

}  // namespace stillkite
