// Camera velocity from one image pair: error relative to the Cramer-Rao bound and run time,
// compared with OpenCV's optical flow. Methods run interleaved: other load of the machine affects
// all of them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "cramer_rao.hpp"
#include "estimation/ego_motion/least_squares.hpp"
#include "estimation/ego_motion/motion_filter.hpp"
#include "estimation/plane/keyframe_pose.hpp"
#include "flow/dense_lucas_kanade.hpp"
#include "flow/flow_sampler.hpp"
#include "flow/opencv_flow.hpp"
#include "geometry/median.hpp"

namespace stillkite::bench {
namespace {

constexpr double kNoise_grey = 1.5;
constexpr double kInitialError_px = 2;
constexpr int kMinPairs = 50;  // fewer pairs: the RMS may be below a true bound by chance

struct PairEstimate {
  std::optional<Twist> twist;
  double flow_ms = 0;
  double total_ms = 0;
};

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// Constant twist in camera between two poses.
Twist screw_between(const RigidTransform& previous_from_current, double dt_s) {
  const Eigen::Vector3d rotation_vector = so3_log(previous_from_current.rotation);
  const Eigen::Vector3d v =
      so3_left_jacobian(rotation_vector).partialPivLu().solve(previous_from_current.translation);
  return {v / dt_s, rotation_vector / dt_s};
}

// Initial motion: truth displaced sideways by kInitialError_px, direction by seed.
PlaneMotion initial_motion(const BenchScene& scene, int seed) {
  PlaneMotion initial = motion_between(scene.world_from_previous, scene.world_from_current);
  initial.translation += kInitialError_px / scene.camera.focal_x_px *
                         Eigen::Vector3d(std::cos(2.4 * seed), std::sin(2.4 * seed), 0);
  return initial;
}

class TileMethod {
 public:
  TileMethod(const Camera& camera, const PlaneAlignmentConfig& config)
      : config_(config), aligner_(camera, config) {}

  PairEstimate operator()(const BenchScene& scene, const FramePair& pair,
                          const PlaneMotion& initial) {
    // untimed: the pyramid of the previous frame exists already
    pyramid_.build(pair.previous, config_.levels);
    aligner_.set_reference(pyramid_);
    const auto start = std::chrono::steady_clock::now();
    pyramid_.build(pair.current, config_.levels);
    const PlaneAlignment alignment = aligner_.align(pyramid_, initial, {});
    PairEstimate estimate;
    estimate.flow_ms = ms_since(start);
    const double height_m = scene.ground.height_m;
    const RigidTransform previous_from_current =
        RigidTransform{alignment.motion.rotation, height_m * alignment.motion.translation}
            .inverse();
    // filter step for its run time only
    MotionFilter filter{MotionFilterConfig{}};
    filter.initialize(RigidTransform{}, height_m, 1);
    filter.predict(scene.interval_s);
    filter.update(previous_from_current, alignment.covariance.topLeftCorner<6, 6>());
    estimate.total_ms = ms_since(start);
    if (alignment.solvable) estimate.twist = screw_between(previous_from_current, scene.interval_s);
    return estimate;
  }

 private:
  PlaneAlignmentConfig config_;
  PlaneAligner aligner_;
  Pyramid pyramid_;
};

// Optical flow and robust least squares of the exact motion field.
class FlowMethod {
 public:
  using Flow = std::function<const FlowField&(const cv::Mat&, const cv::Mat&)>;
  FlowMethod(const Camera& camera, Flow flow, int stride_px)
      : flow_(std::move(flow)),
        sampler_(stride_px),
        solver_(camera, {.weighting = Weighting::robust}) {}

  PairEstimate operator()(const BenchScene& scene, const FramePair& pair) {
    const auto start = std::chrono::steady_clock::now();
    const FlowField& field = flow_(pair.previous, pair.current);
    PairEstimate estimate;
    estimate.flow_ms = ms_since(start);
    const EgoMotion motion = solver_.solve(sampler_(field), scene.ground, scene.interval_s);
    estimate.total_ms = ms_since(start);
    if (motion.verdict == Verdict::ok) estimate.twist = motion.twist;
    return estimate;
  }

 private:
  Flow flow_;
  FlowSampler sampler_;
  EgoMotionSolver solver_;
};

struct Method {
  std::string name;
  std::function<PairEstimate(const BenchScene&, const FramePair&, const PlaneMotion&)> run;
  double max_ratio = 0;  // of RMS over the bound; 0: unchecked
  std::vector<Vector6d> errors;
  std::vector<double> flow_ms, total_ms;
  int failed = 0;
};

std::vector<Method> make_methods(const Camera& camera, bool scene_a) {
  std::vector<Method> methods;
  const auto tiles = [&](const std::string& name, const PlaneAlignmentConfig& config,
                         double max_ratio) {
    auto method = std::make_shared<TileMethod>(camera, config);
    methods.push_back({name,
                       [method](const BenchScene& s, const FramePair& p, const PlaneMotion& g) {
                         return (*method)(s, p, g);
                       },
                       max_ratio});
  };
  const auto flow = [&](const std::string& name, FlowMethod::Flow run, int stride_px) {
    auto method = std::make_shared<FlowMethod>(camera, std::move(run), stride_px);
    const auto estimate = [method](const BenchScene& s, const FramePair& p, const PlaneMotion&) {
      return (*method)(s, p);
    };
    methods.push_back(Method{.name = name, .run = estimate});
  };
  tiles("tiles, fast (32x24)",
        {.levels = 3, .tile_columns = 32, .tile_rows = 24, .solver = {.reweightings = 1}},
        scene_a ? 1.3 : 2.6);
  tiles("tiles, accurate (16x16)", {.tile_rows = 16}, scene_a ? 1.3 : 1.8);
  tiles("tiles, the default (16x8)", {}, 0);
  auto dense = std::make_shared<DenseLucasKanade>(DenseLucasKanadeConfig{});
  flow(
      "dense Lucas-Kanade",
      [dense](const cv::Mat& a, const cv::Mat& b) -> const FlowField& { return (*dense)(a, b); },
      8);
  const auto opencv = [&](const std::string& name, OpenCvFlowMethod method, int stride_px) {
    auto run = std::make_shared<OpenCvFlow>(OpenCvFlowConfig{.method = method});
    flow(
        name,
        [run](const cv::Mat& a, const cv::Mat& b) -> const FlowField& { return (*run)(a, b); },
        stride_px);
  };
  opencv("OpenCV DIS ultrafast", OpenCvFlowMethod::dis_ultrafast, 8);
  opencv("OpenCV DIS fast", OpenCvFlowMethod::dis_fast, 8);
  opencv("OpenCV DIS medium", OpenCvFlowMethod::dis_medium, 8);
  opencv("OpenCV Farneback", OpenCvFlowMethod::farneback, 8);
  opencv("OpenCV pyramidal LK, stride 8", OpenCvFlowMethod::pyramidal_lucas_kanade, 8);
  return methods;
}

// Prints the table. False if an RMS is below the bound or above the maximum ratio of its method.
bool report(const std::vector<Method>& methods, double bound_m_s, bool check_ratios) {
  const auto flow_ms_of = [&](const std::string& name) {
    for (const Method& m : methods) {
      if (m.name == name) return median(m.flow_ms);
    }
    return std::nan("");
  };
  const double dis_fast_ms = flow_ms_of("OpenCV DIS fast");
  const double pyramidal_ms = flow_ms_of("OpenCV pyramidal LK, stride 8");
  fmt::print("{:<30} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}\n", "method", "ms", "DISf/ms",
             "pLK/ms", "bias m/s", "rms m/s", "bias/CRB", "rms/CRB", "failed");
  bool passed = true;
  for (const Method& m : methods) {
    Vector6d mean = Vector6d::Zero();
    double square = 0;
    for (const Vector6d& e : m.errors) {
      mean += e / static_cast<double>(m.errors.size());
      square += e.head<3>().squaredNorm() / static_cast<double>(m.errors.size());
    }
    const double rms = std::sqrt(square);
    const double ms = median(m.total_ms);
    fmt::print("{:<30} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.5f} {:>9.5f} {:>9.2f} {:>9.2f} {:>8}\n",
               m.name, ms, dis_fast_ms / ms, pyramidal_ms / ms, mean.head<3>().norm(), rms,
               mean.head<3>().norm() / bound_m_s, rms / bound_m_s, m.failed);
    if (m.errors.size() >= kMinPairs && rms < 0.9 * bound_m_s) {
      fmt::print(stderr, "{}: RMS below the Cramer-Rao bound; check the bound\n", m.name);
      passed = false;
    }
    if (check_ratios && m.max_ratio > 0 && !(rms <= m.max_ratio * bound_m_s)) {
      fmt::print(stderr, "{}: RMS {:.2f} times the bound, maximum {}\n", m.name, rms / bound_m_s,
                 m.max_ratio);
      passed = false;
    }
  }
  return passed;
}

void try_method(Method& method, const BenchScene& scene, const FramePair& pair,
                const PlaneMotion& initial) {
  const PairEstimate estimate = method.run(scene, pair, initial);
  method.flow_ms.push_back(estimate.flow_ms);
  method.total_ms.push_back(estimate.total_ms);
  if (estimate.twist) {
    method.errors.emplace_back(estimate.twist->vector() - scene.twist_in_camera.vector());
  } else {
    ++method.failed;
  }
}

// Aliasing of one ground is a systematic error that noise seeds do not average out: several
// grounds.
bool run_scene(const std::string& name, const BenchMotion& motion, const std::string& photograph,
               int grounds, int seeds) {
  cv::Mat texture;
  if (!photograph.empty()) {
    texture = cv::imread(photograph, cv::IMREAD_GRAYSCALE);
    if (texture.empty()) throw InputError(photograph + ": not an image");
    grounds = 1;
  }
  std::vector<Method> methods;
  double squared_bound_m2_s2 = 0;
  for (int ground = 1; ground <= grounds; ++ground) {
    const BenchScene scene = make_bench_scene(motion, texture, static_cast<std::uint64_t>(ground));
    squared_bound_m2_s2 +=
        cramer_rao_bound(scene, kNoise_grey).topLeftCorner<3, 3>().trace() / grounds;
    if (methods.empty()) methods = make_methods(scene.camera, &motion == &kBenchSceneA);
    for (int seed = 0; seed < seeds; ++seed) {
      const FramePair pair =
          with_noise(scene, kNoise_grey, 1000 * static_cast<unsigned>(ground) + seed);
      const PlaneMotion initial = initial_motion(scene, seed);
      for (Method& m : methods) try_method(m, scene, pair, initial);
    }
  }
  const double bound_m_s = std::sqrt(squared_bound_m2_s2);
  fmt::print("\nscene {} over {}: bound {:.5f} m/s, {:.3f} % of the speed; {} seeds\n", name,
             photograph.empty() ? fmt::format("{} procedural grounds", grounds) : photograph,
             bound_m_s, 100 * bound_m_s / motion.forward_m_s, grounds * seeds);
  return report(methods, bound_m_s, photograph.empty());
}

int compare(int argc, char** argv) {
  CLI::App app{
      "Camera velocity from one pair of 1920x1080 images, scenes A and B: error and run time.\n"
      "Exit status 1 if a tile method exceeds its maximum ratio or, from 50 pairs, an RMS is below "
      "the Cramer-Rao bound."};
  int grounds = 5;
  int seeds = 10;
  std::string photograph;
  app.add_option("--grounds", grounds, "number of procedural grounds")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--seeds", seeds, "noise seeds per ground")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--photograph", photograph,
                 "ground texture from an image instead of the procedural one");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  const bool a = run_scene("A", kBenchSceneA, photograph, grounds, seeds);
  const bool b = run_scene("B", kBenchSceneB, photograph, grounds, seeds);
  return a && b ? 0 : 1;
}

}  // namespace
}  // namespace stillkite::bench

int main(int argc, char** argv) {
  try {
    return stillkite::bench::compare(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
