// Video faults that time stamps do not show: repeated and re-encoded frames, frozen video, missing
// frames; static overlays and airframe in view. A simulated flight with each fault is encoded,
// decoded and navigated by each policy from its images alone.

#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>
#include <vector>

#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "simulation/flight/simulate.hpp"

namespace {

using namespace stillkite;

struct Flight {
  FlightRecord record;
  std::vector<cv::Mat> images;
};

// Image shown in each frame of a video, and image of its time stamp.
struct Video {
  std::string name;
  std::vector<std::size_t> shown, expected;
  std::function<void(cv::Mat&)> paint;  // overlay on each image, BGR
};

struct Codec {
  const char* fourcc;
  const char* extension;
};

// Landing legs on 20 % of the image.
void paint_legs(cv::Mat& image) {
  const cv::Size size(image.cols / 7, image.rows * 2 / 3);
  for (const int left : {0, image.cols - size.width}) {
    const cv::Rect leg({left, image.rows - size.height}, size);
    cv::rectangle(image, leg, cv::Scalar::all(45), -1);
    for (int y = leg.y + 20; y < image.rows; y += 60) {
      for (int x = left + 20; x < left + leg.width; x += 30) {
        cv::circle(image, {x, y}, 8, cv::Scalar::all(200), -1, cv::LINE_AA);
      }
    }
  }
}

void paint_text(cv::Mat& image) {
  const int right = image.cols - 170, bottom = image.rows - 20;
  for (const auto& [text, at] : {std::pair{"REC 00:12", cv::Point(20, 30)},
                                 {"BAT 15.2V 82%", {right, 30}},
                                 {"ISO 100 1/500", {20, bottom}},
                                 {"N 54.12345", {right, bottom}}}) {
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar::all(0), 3, cv::LINE_AA);
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar::all(255), 1,
                cv::LINE_AA);
  }
}

SimulationConfig demo_flight(int seed) {
  SimulationConfig config;
  config.seed = seed;
  static_cast<SimulatedCameraConfig&>(config.camera) = {.width_px = 640,
                                                        .height_px = 480,
                                                        .focal_x_px = 480,
                                                        .focal_y_px = 480,
                                                        .centre_x_px = 319.5,
                                                        .centre_y_px = 239.5};
  config.flight.duration_s = 8;
  config.flight.height_m = 20;
  config.flight.forward_m = 30;
  config.flight.left_m = 4;
  config.flight.climb_m = -3;
  config.flight.sway_m = 0.3;
  config.ground.side_texels = 3072;
  return config;
}

Flight fly(const SimulationConfig& config) {
  Flight flight{record_flight(config), {}};
  render_flight(config, {},
                [&](const Frame& frame) { flight.images.push_back(frame.grey.clone()); });
  return flight;
}

std::vector<Video> make_videos(std::size_t count) {
  const auto make = [&](const std::string& name, std::size_t frames, auto&& shown,
                        auto&& expected) {
    Video video{.name = name, .shown = {}, .expected = {}, .paint = {}};
    for (std::size_t i = 0; i < frames; ++i) {
      video.shown.push_back(shown(i));
      video.expected.push_back(expected(i));
    }
    return video;
  };
  const auto same = [](std::size_t i) { return i; };
  const std::size_t half = count / 2;
  const auto repeated = [&](std::size_t times) {
    return make(
        fmt::format("each frame {} times", times), count,
        [=](std::size_t i) { return i / times * times; }, same);
  };
  const auto frozen = [&](std::size_t frames) {
    return make(
        fmt::format("frozen for {} frames", frames), count,
        [=](std::size_t i) { return i >= half && i < half + frames ? half : i; }, same);
  };
  const auto cut = [&](std::size_t frames) {
    const auto after = [=](std::size_t i) { return i < half ? i : i + frames; };
    return make(fmt::format("{} frames missing", frames), count - frames, after, after);
  };
  const auto painted = [&](const std::string& name, void (*paint)(cv::Mat&)) {
    Video video = make(name, count, same, same);
    video.paint = paint;
    return video;
  };
  return {make("no fault", count, same, same),
          repeated(2),
          repeated(3),
          frozen(25),
          frozen(50),
          cut(5),
          cut(20),
          painted("legs in view", paint_legs),
          painted("text in view", paint_text)};
}

// Encodes and decodes the video; grey images.
std::vector<cv::Mat> transcode(const Flight& flight, const Video& video, const Codec& codec) {
  const std::string path =
      std::filesystem::temp_directory_path() /
      fmt::format("video_faults_{}_{}.{}", getpid(), codec.fourcc, codec.extension);
  const std::string fourcc = codec.fourcc;
  {
    cv::VideoWriter writer(path,
                           cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]), 25,
                           flight.images.front().size());
    if (!writer.isOpened())
      throw InputError("no encoder for " + fourcc + "; install FFmpeg with it");
    cv::Mat colour;
    for (const std::size_t i : video.shown) {
      cv::cvtColor(flight.images[i], colour, cv::COLOR_GRAY2BGR);
      if (video.paint) video.paint(colour);
      writer.write(colour);
    }
  }
  std::vector<cv::Mat> out;
  cv::VideoCapture reader(path);
  for (cv::Mat colour, grey; reader.read(colour); out.push_back(grey.clone())) {
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  }
  std::filesystem::remove(path);
  if (out.size() != video.shown.size())
    throw InputError(fourcc + ": number of decoded frames differs");
  return out;
}

void evaluate(const Flight& flight, const Video& video, const Codec& codec, Policy policy,
              const std::vector<cv::Mat>& images) {
  constexpr double kMaxNormalizedError = 5;
  Navigator navigator(
      flight.record.camera, flight.record.body_from_camera, {},
      {flight.record.truth.front().state.world_from_body, ScaleSource::initial_height},
      {.policy = policy});
  double max_error_m = 0, end_error_m = 0;
  int inconsistent = 0, frozen = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    const NavigationEstimate e = navigator.step({flight.record.truth[i].stamp, index, images[i]});
    const RigidTransform& truth = flight.record.truth[video.expected[i]].state.world_from_body;
    const Eigen::Vector3d error_m = e.world_from_body.translation - truth.translation;
    const Eigen::Vector3d sigma = e.pose_covariance.diagonal().head<3>().cwiseSqrt();
    end_error_m = error_m.norm();
    max_error_m = std::max(max_error_m, end_error_m);
    frozen += e.verdict == Verdict::frozen ? 1 : 0;
    inconsistent += e.verdict == Verdict::ok &&
                            (error_m.cwiseAbs() - kMaxNormalizedError * sigma).maxCoeff() > 0
                        ? 1
                        : 0;
  }
  fmt::print("{:<5} {:<22} {:<10} {:7.3f} {:7.3f} {:6} {:6}\n", codec.fourcc, video.name,
             name_of(policy), end_error_m, max_error_m, frozen, inconsistent);
}

int run(int argc, char** argv) {
  CLI::App app(
      "Position error of each policy on videos with repeated, frozen or missing frames and static "
      "overlays");
  int seed = 1;
  app.add_option("--seed", seed, "seed of flight, ground and noise")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const Flight flight = fly(demo_flight(seed));
  fmt::print(
      "position error at the end and maximum, m; frames frozen; frames ok with error above 5 sigma "
      "(>5sig)\n");
  fmt::print("{:<5} {:<22} {:<10} {:>7} {:>7} {:>6} {:>6}\n", "codec", "video", "policy", "end",
             "max", "frozen", ">5sig");
  for (const Codec& codec : {Codec{"avc1", "mp4"}, {"mp4v", "mp4"}, {"MJPG", "avi"}}) {
    for (const Video& video : make_videos(flight.images.size())) {
      const std::vector<cv::Mat> images = transcode(flight, video, codec);
      for (const Policy policy : {Policy::flow, Policy::best, Policy::fused}) {
        evaluate(flight, video, codec, policy, images);
        std::fflush(stdout);
      }
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_video_faults: {}\n", error.what());
    return 1;
  }
}
