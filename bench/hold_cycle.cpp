// What one frame of a hover costs, from grey image to command, and how well its pose is known:
// the hold paper's steps in OpenCV calls and ours, from the reference estimator alone to both
// estimators and the IMU fused, take turns on the same rendered frames of a room. Prints a row of
// medians for each, "times" how many of its cycles go into one of OpenCV's; below, what starting
// cold and rendering such a frame cost.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/hold_contestants.hpp"
#include "bench/hover_imu.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/room_scene.hpp"

namespace stillkite::bench {
namespace {

struct Options {
  int flights = 3;
  int frames = 30;
  int seed = 1;
  double radius_m = 0.2;
};

struct Costs {
  std::vector<double> render_ms, develop_ms;
  double room_ms = 0, renderer_ms = 0;  // once
};

ReferenceConfig paper_parameters() {
  ReferenceConfig config;
  config.detector = DetectorConfig{};
  return config;
}

struct Contest {
  OpenCvContestant ransac{"OpenCV, paper's (RANSAC)", cv::RANSAC};
  OpenCvContestant magsac{"OpenCV, paper's but USAC_MAGSAC", cv::USAC_MAGSAC};
  WarmPilot paper{"ours, paper's parameters, warm", {.reference = paper_parameters()}};
  ColdPilot paper_cold{"ours, paper's parameters, cold", {.reference = paper_parameters()}};
  WarmPilot recommended{"ours, recommended, warm", {}};
  ColdPilot recommended_cold{"ours, recommended, cold", {}};
  WarmPilot best{"ours, best of both, warm", {.policy = Policy::best}};
  WarmPilot fused{"ours, both and IMU fused, warm", {.policy = Policy::fused}};

  void start(const cv::Mat& reference, double height_m) {
    for (WarmPilot* pilot : {&paper, &recommended, &best, &fused}) {
      pilot->start(reference, height_m);
    }
  }
  void settle(const HoverInstant& instant) {
    for (WarmPilot* pilot : {&paper, &recommended, &best, &fused}) pilot->settle(instant);
  }
  // in turn, so that what slows the machine for a while slows all
  void run(const cv::Mat& reference, const HoverInstant& instant) {
    ransac.run(reference, instant);
    fused.run(instant);
    recommended.run(instant);
    recommended_cold.run(reference, instant);
    magsac.run(reference, instant);
    best.run(instant);
    paper.run(instant);
    paper_cold.run(reference, instant);
  }
};

void fly(Contest& contest, Costs& costs, const PatchScene& scene, const PatchRenderer& renderer,
         const Options& options, Random& random) {
  const double frames_per_s = hover_camera().frames_per_s;
  const Eigen::Vector3d at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(1.2, 2.6));
  const Hover hover{{so3_exp({0, 0, random.uniform(-3.1, 3.1)}), at}, options.radius_m};
  const View reference = view_of(scene, renderer, hover, 0, random.bits());
  const RigidTransform reference_from_world = reference.world_from_camera.inverse();
  HoverImu imu(hover, random.bits());
  contest.start(reference.grey, at.z());
  // until then the fusion goes through its start again
  constexpr double kStarted_s = 2;
  const int settled = static_cast<int>(kStarted_s * frames_per_s);
  for (int frame = 1; frame <= settled + options.frames; ++frame) {
    const double t_s = frame / frames_per_s;
    const Timestamp now = from_seconds(t_s);
    HoverInstant instant{.index = frame,
                         .view = view_of(scene, renderer, hover, t_s, random.bits()),
                         .tethered = {.now = now,
                                      .tether = TetherReading{now, {.length_m = 2}},
                                      .station_from_body = Eigen::Quaterniond::Identity(),
                                      .others = {}},
                         .imu = imu.read_until(t_s),
                         .reference_from_camera = {}};
    instant.reference_from_camera = reference_from_world * instant.view.world_from_camera;
    if (frame <= settled) {
      contest.settle(instant);
      continue;
    }
    costs.render_ms.push_back(instant.view.render_ms);
    costs.develop_ms.push_back(instant.view.develop_ms);
    contest.run(reference.grey, instant);
  }
}

void print_row(const ContestantRow& row, double opencv_ms) {
  const double whole_ms = row.median_ms("cycle");
  fmt::print("{:<34}{:>10.2f}{:>9.2f}{:>8.2f}{:>8.2f}{:>8.2f}{:>9.3f}{:>8.2f}{:>9.1f}", row.name,
             row.median_ms("reference"), row.median_ms("pyramid"), row.median_ms("flow"),
             row.median_ms("solve"), row.median_ms("filter"), row.median_ms("control"), whole_ms,
             opencv_ms / whole_ms);
  fmt::print("{:>10.4f}{:>10.3f}{:>7}{:>6}/{}\n", median_of(row.rotation_deg),
             median_of(row.direction_deg), median_of(row.features), row.answers, row.frames);
}

void print(const Contest& contest, const Costs& costs) {
  const ContestantRow& paper = contest.ransac.row();
  const ContestantRow& cold = contest.recommended_cold.row();
  const double opencv_ms = paper.median_ms("cycle");
  fmt::print("{:<34}{:>10}{:>9}{:>8}{:>8}{:>8}{:>9}{:>8}{:>9}{:>10}{:>10}{:>7}{:>9}\n",
             "medians: processor ms, degrees", "reference", "pyramid", "flow", "solve", "filter",
             "control", "cycle", "times", "rotation", "direction", "found", "answers");
  for (const ContestantRow* row :
       {&paper, &contest.magsac.row(), &contest.paper.row(), &contest.paper_cold.row(),
        &contest.recommended.row(), &cold, &contest.best.row(), &contest.fused.row()}) {
    print_row(*row, opencv_ms);
  }
  fmt::print("\npyramid: one, part of flow; reference: a new one's cost, not part of a cycle\n");
  fmt::print("solve of the paper's:");
  for (const char* call : {"undistortPoints", "findEssentialMat", "correctMatches", "recoverPose"})
    fmt::print(" {} {:.2f}", call, paper.median_ms(call));
  const double cold_ms = cold.median_ms("reference") + cold.median_ms("cycle");
  const double opencv_cold_ms = paper.median_ms("reference") + opencv_ms;
  fmt::print(
      "\ncold start with its reference: recommended {:.2f} ms, 1/{:.1f} of OpenCV's cycle, "
      "1/{:.1f} of it with its reference\n",
      cold_ms, opencv_ms / cold_ms, opencv_cold_ms / cold_ms);
  const std::vector<double>& start_ms = contest.fused.row().ms.at("start");
  fmt::print("the fusion's frames before those: {:.2f} ms, the longest {:.2f} ms\n",
             median_of(start_ms), *std::max_element(start_ms.begin(), start_ms.end()));
  const double view_ms = median_of(costs.render_ms) + median_of(costs.develop_ms);
  fmt::print(
      "a view: render {:.2f} + develop {:.2f} = {:.2f} ms, {:.2f} of the recommended cycle\n",
      median_of(costs.render_ms), median_of(costs.develop_ms), view_ms,
      view_ms / contest.recommended.row().median_ms("cycle"));
  fmt::print("made once: room {:.0f} ms, renderer {:.0f} ms\n", costs.room_ms, costs.renderer_ms);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Frame to command of a hover in a rendered room at 800x480, OpenCV's way and ours");
  app.add_option("--flights", options.flights, "from different places")->check(CLI::Range(1, 1000));
  app.add_option("--frames", options.frames, "measured of each flight")
      ->check(CLI::Range(1, 100000));
  app.add_option("--seed", options.seed, "of room, places and noise");
  app.add_option("--radius-m", options.radius_m, "of the hover; 0.2 is 4 to 7 % of the depth");
  CLI11_PARSE(app, argc, argv);

  cv::setNumThreads(1);
  const auto seed = static_cast<std::uint64_t>(options.seed);
  Costs costs;
  ProcessorWatch watch;
  const PatchScene scene = make_room(seed);
  costs.room_ms = watch.lap_ms();
  const PatchRenderer renderer(hover_camera().lens(), hover_camera().supersampling);
  costs.renderer_ms = watch.lap_ms();
  Random random(seed, 1);
  Contest contest;
  for (int flight = 0; flight < options.flights; ++flight) {
    fly(contest, costs, scene, renderer, options, random);
  }
  print(contest, costs);
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
