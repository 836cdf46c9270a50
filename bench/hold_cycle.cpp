// What one frame of a hover costs, from grey picture to command, and how well its pose is known:
// the hold paper's steps in OpenCV calls and ours take turns on the same rendered frames of a room.
// What rendering such a frame costs stands below.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/hover_views.hpp"
#include "bench/opencv_hold.hpp"
#include "bench/processor_watch.hpp"
#include "flow/pyramid.hpp"
#include "geometry/angle.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/stop_watch.hpp"
#include "simulation/random.hpp"
#include "simulation/room_scene.hpp"

namespace stillkite::bench {
namespace {

double median_ms(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// One way to a command, with what was measured of it.
struct Row {
  std::string name;
  std::map<std::string, std::vector<double>> ms;  // a stage, "cycle" the whole of a frame
  std::vector<double> rotation_deg, direction_deg, features;
  int answers = 0, frames = 0;

  void judge(const MotionEstimate& motion, int found, const RigidTransform& truth) {
    ++frames;
    features.push_back(found);
    const bool answered = motion.status == EstimateStatus::ok &&
                          motion.displacement_kind == DisplacementKind::direction;
    if (!answered) return;
    ++answers;
    const Eigen::Vector3d& a = motion.displacement_in_reference;
    const Eigen::Vector3d& b = truth.translation;
    rotation_deg.push_back(angle_between_rad(motion.reference_from_camera, truth.rotation) /
                           kDegree);
    direction_deg.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree);
  }
};

class OpenCvContestant {
 public:
  OpenCvContestant(const std::string& name, int method)
      : row_{.name = name}, hold_(hover_camera().lens(), method), controller_(paper_control()) {}

  void run(const cv::Mat& reference, const View& view, const TetheredReadings& readings,
           const RigidTransform& truth) {
    ProcessorWatch watch;
    hold_.set_reference(reference);
    row_.ms["reference"].push_back(watch.lap_ms());
    OpenCvHoldEstimate estimate = hold_.step(view.grey);
    const double estimate_ms = watch.lap_ms();
    estimate.motion.stamp = readings.now;
    (void)controller_.decide({.now = readings.now,
                              .estimate = estimate.motion,
                              .tether = readings.tether,
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
    row_.judge(estimate.motion, estimate.features, truth);
  }
  [[nodiscard]] const Row& row() const { return row_; }

 private:
  static HoldConfig paper_control() {
    HoldConfig config;
    config.mode = HoldMode::paper;
    return config;
  }
  Row row_;
  OpenCvHold hold_;
  HoldController controller_;
};

HoverPilot make_pilot(const ReferenceConfig& reference) {
  NavigatorConfig config;
  config.reference = reference;
  return {hover_camera().lens(),
          camera_raised_forward(hover_camera().forward_tilt_deg),
          config,
          {.policy = Policy::reference},
          HoldConfig{},
          {.world_from_body = {Eigen::Quaterniond::Identity(), {0, 0, 2}}}};
}

// The navigator's stages are in wall time.
void note(Row& row, const PilotStep& step, double cycle_ms, double wall_ms,
          const RigidTransform& truth) {
  const auto& stage_ms = step.estimate.stage_ms;
  const double share = cycle_ms / wall_ms;
  const double flow_ms = share * stage_ms[static_cast<std::size_t>(Stage::flow)];
  const double solve_ms = share * stage_ms[static_cast<std::size_t>(Stage::solve)];
  row.ms["flow"].push_back(flow_ms);
  row.ms["solve"].push_back(solve_ms);
  row.ms["control"].push_back(cycle_ms - flow_ms - solve_ms);
  row.ms["cycle"].push_back(cycle_ms);
  row.judge(step.estimate.reference->motion, step.estimate.reference->features, truth);
}

/// Ours twice: flying on from frame to frame, and anew in every frame.
class OurContestant {
 public:
  OurContestant(const std::string& name, const ReferenceConfig& config)
      : warm_{.name = name + ", warm"}, cold_{.name = name + ", cold"}, config_(config) {}

  void start(const cv::Mat& reference) {
    pilot_.emplace(make_pilot(config_));
    (void)pilot_->step({.stamp = from_seconds(0), .index = 0, .grey = reference}, {});
  }
  PilotStep step(const View& view, std::int64_t index, const TetheredReadings& readings) {
    return pilot_->step({.stamp = readings.now, .index = index, .grey = view.grey}, readings);
  }
  void run(const cv::Mat& reference, const View& view, std::int64_t index,
           const TetheredReadings& readings, const RigidTransform& truth) {
    ProcessorWatch watch;
    StopWatch wall;
    const PilotStep flown = step(view, index, readings);
    note(warm_, flown, watch.lap_ms(), wall.lap_ms(), truth);
    HoverPilot anew = make_pilot(config_);
    (void)watch.lap_ms();
    (void)anew.step({.stamp = from_seconds(0), .index = 0, .grey = reference}, {});
    const double reference_ms = watch.lap_ms();
    (void)wall.lap_ms();
    const PilotStep first =
        anew.step({.stamp = from_seconds(1.0 / 30), .index = 1, .grey = view.grey}, readings);
    note(cold_, first, watch.lap_ms(), wall.lap_ms(), truth);
    cold_.ms["reference"].push_back(reference_ms);
    pyramid_.build(view.grey, config_.windows.levels);
    (void)watch.lap_ms();
    pyramid_.build(view.grey, config_.windows.levels);
    const double pyramid_ms = watch.lap_ms();
    for (Row* row : {&warm_, &cold_}) row->ms["pyramid"].push_back(pyramid_ms);
  }
  [[nodiscard]] const Row& warm() const { return warm_; }
  [[nodiscard]] const Row& cold() const { return cold_; }

 private:
  Row warm_, cold_;
  ReferenceConfig config_;
  std::optional<HoverPilot> pilot_;
  Pyramid pyramid_;
};

void print_row(const Row& row, double opencv_ms) {
  const auto stage = [&](const char* name) {
    const auto found = row.ms.find(name);
    return found == row.ms.end() ? 0.0 : median_ms(found->second);
  };
  const double whole_ms = stage("cycle");
  fmt::print("{:<34}{:>10.2f}{:>9.2f}{:>8.2f}{:>8.2f}{:>9.3f}{:>8.2f}{:>9.1f}{:>10.4f}{:>10.3f}",
             row.name, stage("reference"), stage("pyramid"), stage("flow"), stage("solve"),
             stage("control"), whole_ms, opencv_ms / whole_ms, median_ms(row.rotation_deg),
             median_ms(row.direction_deg));
  fmt::print("{:>7}{:>6}/{}\n", median_ms(row.features), row.answers, row.frames);
}

ReferenceConfig paper_parameters() {
  ReferenceConfig config;
  config.detector = DetectorConfig{};
  return config;
}

int run(int argc, char** argv) {
  int flights = 3;
  int frames = 30;
  int seed = 1;
  double radius_m = 0.2;
  CLI::App app("Frame to command of a hover in a rendered room at 800x480, OpenCV's way and ours");
  app.add_option("--flights", flights, "from different places")->check(CLI::Range(1, 1000));
  app.add_option("--frames", frames, "measured of each flight")->check(CLI::Range(1, 100000));
  app.add_option("--seed", seed, "of room, places and noise");
  app.add_option("--radius-m", radius_m, "of the hover; 0.2 is 4 to 7 % of the depth");
  CLI11_PARSE(app, argc, argv);

  cv::setNumThreads(1);
  ProcessorWatch room_watch;
  const PatchScene scene = make_room(static_cast<std::uint64_t>(seed));
  const double room_ms = room_watch.lap_ms();
  const SimulatedCameraConfig camera = hover_camera();
  const PatchRenderer renderer(camera.lens(), camera.supersampling);
  const double renderer_ms = room_watch.lap_ms();
  Random random(static_cast<std::uint64_t>(seed), 1);

  OpenCvContestant ransac("OpenCV, paper's (RANSAC)", cv::RANSAC);
  OpenCvContestant magsac("OpenCV, paper's but USAC_MAGSAC", cv::USAC_MAGSAC);
  OurContestant paper("ours, paper's parameters", paper_parameters());
  OurContestant recommended("ours, recommended", ReferenceConfig{});
  std::vector<double> render_ms, develop_ms;
  for (int flight = 0; flight < flights; ++flight) {
    const Eigen::Vector3d at(random.uniform(-1, 1), random.uniform(-1, 1),
                             random.uniform(1.2, 2.6));
    const Hover hover{{so3_exp({0, 0, random.uniform(-3.1, 3.1)}), at}, radius_m};
    const View reference = view_of(scene, renderer, hover, 0, random.bits());
    const RigidTransform reference_from_world = reference.world_from_camera.inverse();
    paper.start(reference.grey);
    recommended.start(reference.grey);
    const int settled = static_cast<int>(Hover::kSettle_s * camera.frames_per_s);
    for (int frame = 1; frame <= settled + frames; ++frame) {
      const double t_s = frame / camera.frames_per_s;
      const View view = view_of(scene, renderer, hover, t_s, random.bits());
      const Timestamp now = from_seconds(t_s);
      const TetheredReadings readings{.now = now,
                                      .tether = TetherReading{now, {.length_m = 2}},
                                      .station_from_body = Eigen::Quaterniond::Identity(),
                                      .others = {}};
      if (frame <= settled) {
        (void)paper.step(view, frame, readings);
        (void)recommended.step(view, frame, readings);
        continue;
      }
      const RigidTransform truth = reference_from_world * view.world_from_camera;
      render_ms.push_back(view.render_ms);
      develop_ms.push_back(view.develop_ms);
      ransac.run(reference.grey, view, readings, truth);
      recommended.run(reference.grey, view, frame, readings, truth);
      magsac.run(reference.grey, view, readings, truth);
      paper.run(reference.grey, view, frame, readings, truth);
    }
  }

  fmt::print("{:<34}{:>10}{:>9}{:>8}{:>8}{:>9}{:>8}{:>9}{:>10}{:>10}{:>7}{:>9}\n",
             "medians: processor ms, degrees", "reference", "pyramid", "flow", "solve", "control",
             "cycle", "times", "rotation", "direction", "found", "answers");
  const double opencv_ms = median_ms(ransac.row().ms.at("cycle"));
  for (const Row* row : {&ransac.row(), &magsac.row(), &paper.warm(), &paper.cold(),
                         &recommended.warm(), &recommended.cold()}) {
    print_row(*row, opencv_ms);
  }
  fmt::print("\npyramid: part of flow; reference: not part of a cycle, a new reference's cost\n");
  fmt::print("solve of the paper's:");
  for (const char* call : {"undistortPoints", "findEssentialMat", "correctMatches", "recoverPose"})
    fmt::print(" {} {:.2f}", call, median_ms(ransac.row().ms.at(call)));
  const double cold_ms = median_ms(recommended.cold().ms.at("reference")) +
                         median_ms(recommended.cold().ms.at("cycle"));
  const double opencv_cold_ms = median_ms(ransac.row().ms.at("reference")) + opencv_ms;
  fmt::print(
      "\ncold start with its reference: recommended {:.2f} ms, 1/{:.1f} of OpenCV's cycle, "
      "1/{:.1f} of it with its reference\n",
      cold_ms, opencv_ms / cold_ms, opencv_cold_ms / cold_ms);
  const double view_ms = median_ms(render_ms) + median_ms(develop_ms);
  fmt::print(
      "a view: render {:.2f} + develop {:.2f} = {:.2f} ms, {:.2f} of the recommended cycle\n",
      median_ms(render_ms), median_ms(develop_ms), view_ms,
      view_ms / median_ms(recommended.warm().ms.at("cycle")));
  fmt::print("made once: room {:.0f} ms, renderer {:.0f} ms\n", room_ms, renderer_ms);
  return 0;
}

}  // namespace
}  // namespace stillkite::bench

int main(int argc, char** argv) {
  try {
    return stillkite::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
