// Rotation and direction error between two rendered images of a room: the hold paper's comparison
// of detectors and associations, with Stillkite's method. Every pair is a cold start without prior.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "flow/frame.hpp"
#include "geometry/angle.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "navigation/stop_watch.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/plant_config.hpp"
#include "simulation/random.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"

namespace {

using namespace stillkite;

struct Variant {
  std::string name;
  ReferenceConfig config;
};

ReferenceConfig hold_paper_with(Detector detector, Association association,
                                EssentialMethod essential = EssentialMethod::ransac) {
  ReferenceConfig config;
  config.detector = DetectorConfig{.kind = detector};
  config.association = association;
  config.solver = PoseSolver::opencv;
  config.opencv_pose.essential_method = essential;
  return config;
}

std::vector<Variant> variants() {
  const auto paper = hold_paper_with;
  ReferenceConfig own_solver =
      paper(Detector::shi_tomasi, Association::opencv, EssentialMethod::ransac);
  own_solver.solver = PoseSolver::own;
  return {
      {"shi_tomasi, opencv LK, ransac (hold paper)",
       paper(Detector::shi_tomasi, Association::opencv, EssentialMethod::ransac)},
      {"fast, opencv LK, ransac",
       paper(Detector::fast, Association::opencv, EssentialMethod::ransac)},
      {"sift, opencv LK, ransac",
       paper(Detector::sift, Association::opencv, EssentialMethod::ransac)},
      {"shi_tomasi, matching, ransac",
       paper(Detector::shi_tomasi, Association::matching, EssentialMethod::ransac)},
      {"sift, matching, ransac",
       paper(Detector::sift, Association::matching, EssentialMethod::ransac)},
      {"orb, matching, ransac",
       paper(Detector::orb, Association::matching, EssentialMethod::ransac)},
      {"shi_tomasi, opencv LK, magsac",
       paper(Detector::shi_tomasi, Association::opencv, EssentialMethod::usac_magsac)},
      {"shi_tomasi, opencv LK, own solver", own_solver},
      {"windows, own solver (recommended)", ReferenceConfig{}},
  };
}

struct Pair {
  cv::Mat reference, current;
  RigidTransform reference_from_camera;
};

// Camera of the hover trials at a random position in the room, and displaced by `displacement_m`.
Pair make_pair_of_views(const PatchScene& scene, const PatchRenderer& renderer,
                        double displacement_m, Random& random) {
  const SimulatedCameraConfig camera = hover_camera();
  const RigidTransform mount = camera_raised_forward(camera.forward_tilt_deg);
  const auto body = [&](const Eigen::Vector3d& position_m, double yaw_rad) {
    return RigidTransform{so3_exp({0, 0, yaw_rad}), position_m};
  };
  const Eigen::Vector3d at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(1.2, 2.6));
  const double yaw_rad = random.uniform(-3.1, 3.1);
  Eigen::Vector3d displacement(random.normal(), random.normal(), random.normal());
  displacement *= displacement_m / displacement.norm();
  const RigidTransform before = body(at, yaw_rad) * mount;
  const RigidTransform after =
      body(at + displacement, yaw_rad + random.uniform(-4, 4) * kDegree) * mount;
  const auto image = [&](const RigidTransform& pose) {
    return develop(renderer.render(scene, pose), {.noise_grey = camera.noise_grey}, random.bits());
  };
  return {image(before), image(after), before.inverse() * after};
}

struct PairResult {
  double rotation_deg = 180, direction_deg = 180, ms = 0;
  bool valid = false;
};

PairResult compare(const Variant& variant, const Pair& pair) {
  const Camera lens = hover_camera().lens();
  NavigatorConfig config;
  config.reference = variant.config;
  config.reference.min_features = 20;
  Navigator navigator(lens, camera_raised_forward(75), config,
                      {.world_from_body = {Eigen::Quaterniond::Identity(), {0, 0, 2}}},
                      {.policy = Policy::reference});
  (void)navigator.step({.stamp = from_seconds(0), .index = 0, .grey = pair.reference});
  StopWatch watch;
  const NavigationEstimate estimate =
      navigator.step({.stamp = from_seconds(0.1), .index = 1, .grey = pair.current});
  PairResult result{.ms = watch.lap_ms()};
  const MotionEstimate& motion = estimate.reference->motion;
  result.valid = motion.displacement_kind == DisplacementKind::direction;
  if (!result.valid) return result;
  result.rotation_deg =
      angle_between_rad(motion.reference_from_camera, pair.reference_from_camera.rotation) /
      kDegree;
  result.direction_deg =
      angle_between_rad(motion.displacement_in_reference, pair.reference_from_camera.translation) /
      kDegree;
  return result;
}

double quantile(std::vector<double> values, double probability) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(probability * static_cast<double>(values.size() - 1))];
}

void print_row(const Variant& variant, const std::vector<Pair>& pairs) {
  std::vector<double> rotation, direction, ms;
  int valid = 0;
  for (const Pair& pair : pairs) {
    const PairResult result = compare(variant, pair);
    rotation.push_back(result.rotation_deg);
    direction.push_back(result.direction_deg);
    ms.push_back(result.ms);
    if (result.valid) ++valid;
  }
  fmt::print("{:<46}{:>10.3f}{:>10.3f}{:>11.3f}{:>10.2f}{:>8}/{}{:>10.1f}\n", variant.name,
             quantile(rotation, 0.5), quantile(rotation, 0.9), quantile(direction, 0.5),
             quantile(direction, 0.9), valid, pairs.size(), quantile(ms, 0.5));
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  int pair_count = 40;
  int seed = 1;
  double displacement_m = 0.25;
  CLI::App app(
      "Relative pose between two rendered 800x480 images of a room, for the hold paper's variants");
  app.add_option("--pairs", pair_count, "number of image pairs")->check(CLI::Range(1, 100000));
  app.add_option("--seed", seed, "seed of room, positions and noise");
  app.add_option("--way-m", displacement_m,
                 "displacement between the two cameras, m; 0.25 is 5 to 8 % of the depth");
  CLI11_PARSE(app, argc, argv);

  cv::setNumThreads(1);
  const PatchScene scene = make_room(static_cast<std::uint64_t>(seed));
  const PatchRenderer renderer(hover_camera().lens(), hover_camera().supersampling);
  Random random(static_cast<std::uint64_t>(seed), 1);
  std::vector<Pair> pairs;
  pairs.reserve(static_cast<std::size_t>(pair_count));
  for (int i = 0; i < pair_count; ++i)
    pairs.push_back(make_pair_of_views(scene, renderer, displacement_m, random));
  fmt::print("{:<46}{:>10}{:>10}{:>11}{:>10}{:>10}{:>10}\n", "errors in degrees", "rotation",
             "90 %", "direction", "90 %", "valid", "ms");
  for (const Variant& variant : variants()) print_row(variant, pairs);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
