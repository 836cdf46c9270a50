#include "bench/hold_methods.hpp"

#include <algorithm>
#include <cmath>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/pilot_step.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite::bench {
namespace {

HoldConfig paper_control() {
  HoldConfig config;
  config.mode = HoldMode::paper;
  return config;
}

HoverPilot make_pilot(const PilotSetup& setup) {
  NavigatorConfig config;
  config.reference = setup.reference;
  return {hover_camera().lens(),
          camera_raised_forward(hover_camera().forward_tilt_deg),
          config,
          {.policy = setup.policy},
          HoldConfig{},
          {.world_from_body = {Eigen::Quaterniond::Identity(), {0, 0, setup.height_m}},
           .scale = ScaleSource::initial_height}};
}

// Stage times are wall times, scaled to CPU time.
void record(MethodRow& row, const PilotStep& step, double cycle_ms, double wall_ms,
            const RigidTransform& truth) {
  const auto stage_ms = [&](Stage stage) {
    return cycle_ms / wall_ms * step.estimate.stage_ms[static_cast<std::size_t>(stage)];
  };
  const double flow_ms = stage_ms(Stage::pyramid) + stage_ms(Stage::flow);
  const double solve_ms = stage_ms(Stage::solve);
  const double filter_ms = stage_ms(Stage::filter);
  row.ms["flow"].push_back(flow_ms);
  row.ms["solve"].push_back(solve_ms);
  row.ms["filter"].push_back(filter_ms);
  row.ms["control"].push_back(cycle_ms - flow_ms - solve_ms - filter_ms);
  row.ms["cycle"].push_back(cycle_ms);
  row.add(step.estimate.reference->motion, step.estimate.reference->features, truth);
}

}  // namespace

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void MethodRow::add(const MotionEstimate& motion, int tracked, const RigidTransform& truth) {
  ++frames;
  features.push_back(tracked);
  const bool valid = motion.status == EstimateStatus::ok &&
                     (motion.displacement_kind == DisplacementKind::direction ||
                      motion.displacement_kind == DisplacementKind::metric);
  if (!valid) return;
  ++estimates;
  rotation_deg.push_back(angle_between_rad(motion.reference_from_camera, truth.rotation) / kDegree);
  direction_deg.push_back(angle_between_rad(motion.displacement_in_reference, truth.translation) /
                          kDegree);
}

double MethodRow::median_ms(const std::string& stage) const {
  const auto found = ms.find(stage);
  return found == ms.end() ? 0 : median_of(found->second);
}

OpenCvMethod::OpenCvMethod(const std::string& name, int method)
    : row_{.name = name}, hold_(hover_camera().lens(), method), controller_(paper_control()) {}

void OpenCvMethod::run(const cv::Mat& reference, const HoverInstant& instant) {
  ProcessorWatch watch;
  hold_.set_reference(reference);
  row_.ms["reference"].push_back(watch.lap_ms());
  OpenCvHoldEstimate estimate = hold_.step(instant.view.grey);
  const double estimate_ms = watch.lap_ms();
  estimate.motion.stamp = instant.tethered.now;
  (void)controller_.decide({.now = instant.tethered.now,
                            .estimate = estimate.motion,
                            .tether = instant.tethered.tether,
                            .station_from_camera = Eigen::Quaterniond::Identity()});
  const double control_ms = watch.lap_ms();
  row_.ms["control"].push_back(control_ms);
  row_.ms["cycle"].push_back(estimate_ms + control_ms);
  row_.ms["pyramid"].push_back(estimate.ms[kPyramid]);
  row_.ms["flow"].push_back(estimate.ms[kPyramid] + estimate.ms[kFlow]);
  row_.ms["undistortPoints"].push_back(estimate.ms[kUndistort]);
  row_.ms["findEssentialMat"].push_back(estimate.ms[kEssential]);
  row_.ms["correctMatches"].push_back(estimate.ms[kCorrect]);
  row_.ms["recoverPose"].push_back(estimate.ms[kRecover]);
  row_.ms["solve"].push_back(estimate.ms[kUndistort] + estimate.ms[kEssential] +
                             estimate.ms[kCorrect] + estimate.ms[kRecover]);
  row_.add(estimate.motion, estimate.features, instant.reference_from_camera);
}

void WarmPilot::start(const cv::Mat& reference, double height_m) {
  setup_.height_m = height_m;
  pilot_.emplace(make_pilot(setup_));
  (void)pilot_->step(Frame{.stamp = from_seconds(0), .index = 0, .grey = reference}, {});
}

PilotStep WarmPilot::step(const HoverInstant& instant) {
  TetheredReadings readings = instant.tethered;
  if (setup_.policy == Policy::fused) readings.sensors = instant.imu;
  return pilot_->step(
      Frame{.stamp = readings.now, .index = instant.index, .grey = instant.view.grey}, readings);
}

void WarmPilot::warm_up(const HoverInstant& instant) {
  ProcessorWatch watch;
  (void)step(instant);
  row_.ms["start"].push_back(watch.lap_ms());
}

void WarmPilot::run(const HoverInstant& instant) {
  ProcessorWatch watch;
  StopWatch wall;
  const PilotStep result = step(instant);
  record(row_, result, watch.lap_ms(), wall.lap_ms(), instant.reference_from_camera);
  pyramid_.build(instant.view.grey, setup_.reference.windows.levels);
  (void)watch.lap_ms();
  pyramid_.build(instant.view.grey, setup_.reference.windows.levels);
  row_.ms["pyramid"].push_back(watch.lap_ms());
}

void ColdPilot::run(const cv::Mat& reference, const HoverInstant& instant) {
  HoverPilot pilot = make_pilot(setup_);
  ProcessorWatch watch;
  (void)pilot.step(Frame{.stamp = from_seconds(0), .index = 0, .grey = reference}, {});
  row_.ms["reference"].push_back(watch.lap_ms());
  StopWatch wall;
  const PilotStep result =
      pilot.step(Frame{.stamp = from_seconds(1.0 / 30), .index = 1, .grey = instant.view.grey},
                 instant.tethered);
  record(row_, result, watch.lap_ms(), wall.lap_ms(), instant.reference_from_camera);
}

}  // namespace stillkite::bench
