// CPU time per frame of a hover, from grey image to command, and pose error: the hold paper's
// method in OpenCV calls and Stillkite's policies, interleaved on the same rendered frames of a
// room. Prints medians per method; "speedup": OpenCV's cycle time over the method's. Also: cold
// start and rendering.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/hold_methods.hpp"
#include "bench/hover_imu.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/scenes.hpp"

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
  double room_ms = 0, renderer_ms = 0;  // setup
};

ReferenceConfig paper_parameters() {
  ReferenceConfig config;
  config.detector = DetectorConfig{};
  return config;
}

struct Methods {
  OpenCvMethod ransac{"OpenCV, hold paper (RANSAC)", cv::RANSAC};
  OpenCvMethod magsac{"OpenCV, hold paper (USAC_MAGSAC)", cv::USAC_MAGSAC};
  WarmPilot paper{"Stillkite, paper parameters, warm", {.reference = paper_parameters()}};
  ColdPilot paper_cold{"Stillkite, paper parameters, cold", {.reference = paper_parameters()}};
  WarmPilot recommended{"Stillkite, recommended, warm", {}};
  ColdPilot recommended_cold{"Stillkite, recommended, cold", {}};
  WarmPilot best{"Stillkite, best, warm", {.policy = Policy::best}};
  WarmPilot fused{"Stillkite, fused with IMU, warm", {.policy = Policy::fused}};

  void start(const cv::Mat& reference, double height_m) {
    for (WarmPilot* pilot : {&paper, &recommended, &best, &fused}) {
      pilot->start(reference, height_m);
    }
  }
  void warm_up(const HoverInstant& instant) {
    for (WarmPilot* pilot : {&paper, &recommended, &best, &fused}) pilot->warm_up(instant);
  }
  // interleaved: other load of the machine affects all methods
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

void fly(Methods& methods, Costs& costs, const PatchScene& scene, const PatchRenderer& renderer,
         const Options& options, Random& random) {
  const double frames_per_s = hover_camera().frames_per_s;
  const Eigen::Vector3d at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(1.2, 2.6));
  const Hover hover{{so3_exp({0, 0, random.uniform(-3.1, 3.1)}), at}, options.radius_m};
  const View reference = view_of(scene, renderer, hover, 0, random.bits());
  const RigidTransform reference_from_world = reference.world_from_camera.inverse();
  HoverImu imu(hover, random.bits());
  methods.start(reference.grey, at.z());
  // initialization of the fusion
  constexpr double kInitialization_s = 2;
  const int warm_up_frames = static_cast<int>(kInitialization_s * frames_per_s);
  for (int frame = 1; frame <= warm_up_frames + options.frames; ++frame) {
    const double t_s = frame / frames_per_s;
    const Timestamp now = from_seconds(t_s);
    HoverInstant instant{.index = frame,
                         .view = view_of(scene, renderer, hover, t_s, random.bits()),
                         .tethered = {.now = now,
                                      .tether = TetherReading{now, {.length_m = 2}},
                                      .station_from_body = Eigen::Quaterniond::Identity(),
                                      .sensors = {}},
                         .imu = imu.read_until(t_s),
                         .reference_from_camera = {}};
    instant.reference_from_camera = reference_from_world * instant.view.world_from_camera;
    if (frame <= warm_up_frames) {
      methods.warm_up(instant);
      continue;
    }
    costs.render_ms.push_back(instant.view.render_ms);
    costs.develop_ms.push_back(instant.view.develop_ms);
    methods.run(reference.grey, instant);
  }
}

void print_row(const MethodRow& row, double opencv_ms) {
  const double whole_ms = row.median_ms("cycle");
  fmt::print("{:<34}{:>10.2f}{:>9.2f}{:>8.2f}{:>8.2f}{:>8.2f}{:>9.3f}{:>8.2f}{:>9.1f}", row.name,
             row.median_ms("reference"), row.median_ms("pyramid"), row.median_ms("flow"),
             row.median_ms("solve"), row.median_ms("filter"), row.median_ms("control"), whole_ms,
             opencv_ms / whole_ms);
  fmt::print("{:>10.4f}{:>10.3f}{:>8}{:>5}/{}\n", median_of(row.rotation_deg),
             median_of(row.direction_deg), median_of(row.features), row.estimates, row.frames);
}

void print(const Methods& methods, const Costs& costs) {
  const MethodRow& paper = methods.ransac.row();
  const MethodRow& cold = methods.recommended_cold.row();
  const double opencv_ms = paper.median_ms("cycle");
  fmt::print("{:<34}{:>10}{:>9}{:>8}{:>8}{:>8}{:>9}{:>8}{:>9}{:>10}{:>10}{:>8}{:>8}\n",
             "medians: CPU ms, degrees", "reference", "pyramid", "flow", "solve", "filter",
             "control", "cycle", "speedup", "rotation", "direction", "tracked", "valid");
  for (const MethodRow* row :
       {&paper, &methods.magsac.row(), &methods.paper.row(), &methods.paper_cold.row(),
        &methods.recommended.row(), &cold, &methods.best.row(), &methods.fused.row()}) {
    print_row(*row, opencv_ms);
  }
  fmt::print(
      "\npyramid: part of flow; reference: renewal of the reference image, not part of the "
      "cycle\n");
  fmt::print("solve, hold paper:");
  for (const char* call : {"undistortPoints", "findEssentialMat", "correctMatches", "recoverPose"})
    fmt::print(" {} {:.2f}", call, paper.median_ms(call));
  const double cold_ms = cold.median_ms("reference") + cold.median_ms("cycle");
  const double opencv_cold_ms = paper.median_ms("reference") + opencv_ms;
  fmt::print(
      "\ncold start including reference: recommended {:.2f} ms, 1/{:.1f} of OpenCV's cycle, "
      "1/{:.1f} of OpenCV's cycle including reference\n",
      cold_ms, opencv_ms / cold_ms, opencv_cold_ms / cold_ms);
  const std::vector<double>& initialization_ms = methods.fused.row().ms.at("start");
  fmt::print("fusion, initialization frames: median {:.2f} ms, maximum {:.2f} ms\n",
             median_of(initialization_ms),
             *std::max_element(initialization_ms.begin(), initialization_ms.end()));
  const double view_ms = median_of(costs.render_ms) + median_of(costs.develop_ms);
  fmt::print("image: render {:.2f} + develop {:.2f} = {:.2f} ms, {:.2f} of the recommended cycle\n",
             median_of(costs.render_ms), median_of(costs.develop_ms), view_ms,
             view_ms / methods.recommended.row().median_ms("cycle"));
  fmt::print("setup: room {:.0f} ms, renderer {:.0f} ms\n", costs.room_ms, costs.renderer_ms);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Hover in a rendered room at 800x480: time from frame to command and pose error, OpenCV and "
      "Stillkite");
  app.add_option("--flights", options.flights, "number of flights, each at a random position")
      ->check(CLI::Range(1, 1000));
  app.add_option("--frames", options.frames, "frames measured per flight")
      ->check(CLI::Range(1, 100000));
  app.add_option("--seed", options.seed, "seed of room, positions and noise");
  app.add_option("--radius-m", options.radius_m,
                 "radius of the hover, m; 0.2 is 4 to 7 % of the depth");
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
  Methods methods;
  for (int flight = 0; flight < options.flights; ++flight) {
    fly(methods, costs, scene, renderer, options, random);
  }
  print(methods, costs);
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
