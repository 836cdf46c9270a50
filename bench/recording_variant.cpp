// Writes one variant of a recording in EuRoC layout, with truth and sensors that follow exactly.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "codec_round_trip.hpp"
#include "evaluation/association.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/dataset/initial_state.hpp"
#include "io/results/output_file.hpp"
#include "recording_files.hpp"
#include "recording_images.hpp"
#include "recording_motion.hpp"

namespace stillkite::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path config;
  std::vector<std::string> overrides;
  std::string kind;
  double from_ratio = 0;
  double to_ratio = 1;
  bool at_rest = false;
  bool identity_attitude = false;
  fs::path out;
};

struct Kind {
  const char* name;
  Recording (*make)(const Recording&);
};

// Bit rate of a drone's digital link: 4 Mbit/s for 1280x720 at 30 Hz.
constexpr double kBitsPerPixel = 4e6 / (1280 * 720 * 30);
constexpr double kNoise_grey = 6;
constexpr double kLowGain = 0.7;
constexpr int kJpegQuality = 40;

// clang-format off
const std::vector<Kind> kKinds{
    {"recorded", [](const Recording& r) { return r; }},
    {"every_2nd", [](const Recording& r) { return every_nth_image(r, 2); }},
    {"every_3rd", [](const Recording& r) { return every_nth_image(r, 3); }},
    {"backwards", [](const Recording& r) { return backwards(r); }},
    {"mirrored", [](const Recording& r) { return mirrored(r); }},
    {"half_size", [](const Recording& r) { return half_size(r); }},
    {"gamma_0.6", [](const Recording& r) { return with_gamma(r, 0.6); }},
    {"gamma_1.6", [](const Recording& r) { return with_gamma(r, 1.6); }},
    {"noise", [](const Recording& r) { return with_noise(r, kNoise_grey, 1); }},
    {"jpeg", [](const Recording& r) { return with_jpeg(r, kJpegQuality); }},
    {"exposure_steps", [](const Recording& r) { return with_exposure_steps(r, kLowGain); }},
    {"h264", [](const Recording& r) { return with_codec(r, "libx264", kBitsPerPixel); }},
    {"hevc", [](const Recording& r) { return with_codec(r, "libx265", kBitsPerPixel); }},
    {"from_origin", [](const Recording& r) { return from_origin(r); }},
};
// clang-format on

// Constant pose: the initial state of the configuration.
std::vector<StampedPose> poses_at_rest(const Recording& recording, const RunConfig& config) {
  const InitialState initial = initial_state(config, {}, {}, recording.images.front().stamp);
  std::vector<StampedPose> poses;
  for (const RecordedImage& image : recording.images) {
    poses.push_back({image.stamp, initial.world_from_body});
  }
  return poses;
}

// True pose at the first image, as keys of `initial`.
std::string initial_json(const Recording& recording) {
  constexpr double kTolerance_s = 0.1;
  const auto pose = pose_at(recording.poses, recording.images.front().stamp, kTolerance_s);
  if (!pose) throw InputError("the truth does not cover the first image");
  const EulerAngles angles = to_euler(pose->rotation);
  return fmt::format(
      "{{\"height_m\": {:.12g}, \"yaw_deg\": {:.12g}, \"pitch_deg\": {:.12g}, "
      "\"roll_deg\": {:.12g}}}\n",
      pose->translation.z(), angles.yaw_rad / kDegree, angles.pitch_rad / kDegree,
      angles.roll_rad / kDegree);
}

Recording source_of(const Options& options) {
  const RunConfig config = load_run_config(options.config, options.overrides);
  Recording recording = read_recording(config);
  if (options.at_rest) recording.poses = poses_at_rest(recording, config);
  // at rest the attitude may be the identity in every row
  if (options.at_rest || options.identity_attitude) recording = with_rotated_world(recording);
  return part_of(recording, options.from_ratio, options.to_ratio);
}

void write_variant(const Options& options) {
  const auto kind = std::ranges::find(kKinds, options.kind, &Kind::name);
  const Recording variant = kind->make(source_of(options));
  write_recording(variant, options.out);
  if (options.kind == "from_origin") {
    write_file(options.out / "initial.json", initial_json(variant));
  }
}

int run(int argc, char** argv) {
  Options options;
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  CLI::App app("Variant of a recording whose truth follows exactly, in EuRoC layout");
  app.add_option("config", options.config, "configuration of a run: images, calibration, truth")
      ->required();
  app.add_option("--set", options.overrides, "key=value of the configuration")
      ->allow_extra_args(false);
  app.add_option("--kind", options.kind, "variant")->required()->check(CLI::IsMember(names));
  app.add_option("--from", options.from_ratio, "first image, share of the duration")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--to", options.to_ratio, "last image, share of the duration")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--at-rest", options.at_rest, "the truth is the initial pose of the configuration");
  app.add_flag("--identity-attitude", options.identity_attitude,
               "the truth's identities are attitudes");
  app.add_option("--out", options.out, "new folder")->required();
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  write_variant(options);
  return 0;
}

}  // namespace
}  // namespace stillkite::bench

int main(int argc, char** argv) {
  try {
    return stillkite::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_recording_variant: {}\n", error.what());
    return 1;
  }
}
