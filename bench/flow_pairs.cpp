#include "flow_pairs.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "simulation/flight/bench_scene.hpp"

namespace stillkite::bench {
namespace {

namespace fs = std::filesystem;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// Flow of a plane: x' ~ K (R + t n^T / h) K^-1 x.
cv::Mat plane_flow(const BenchScene& scene) {
  const RigidTransform current_from_previous =
      scene.world_from_current.inverse() * scene.world_from_previous;
  const Camera& camera = scene.camera;
  Eigen::Matrix3d K;
  K << camera.focal_x_px, 0, camera.centre_x_px, 0, camera.focal_y_px, camera.centre_y_px, 0, 0, 1;
  const Eigen::Matrix3d H =
      K *
      (current_from_previous.rotation.toRotationMatrix() +
       current_from_previous.translation * scene.ground.normal_in_camera.transpose() /
           scene.ground.height_m) *
      K.inverse();
  cv::Mat flow(camera.height_px, camera.width_px, CV_32FC2);
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(),
                                  Eigen::Vector2d(camera.width_px - 1, camera.height_px - 1));
  for (int y = 0; y < flow.rows; ++y) {
    for (int x = 0; x < flow.cols; ++x) {
      const Eigen::Vector2d from(x, y);
      const Eigen::Vector3d to = H * from.homogeneous();
      const Eigen::Vector2d moved = to.hnormalized();
      const Eigen::Vector2f vector = (moved - from).cast<float>();
      flow.at<cv::Vec2f>(y, x) =
          image.contains(moved) ? cv::Vec2f(vector.x(), vector.y()) : cv::Vec2f(kUnknown, kUnknown);
    }
  }
  return flow;
}

cv::Mat read_grey(const fs::path& file) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw InputError(fmt::format("{}: not an image", file.string()));
  return image;
}

// Middlebury .flo: 202021.25, width, height, then x and y of each vector; |.| > 1e9: unknown.
cv::Mat read_flo(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  float magic = 0;
  std::array<std::int32_t, 2> size{};
  stream.read(reinterpret_cast<char*>(&magic), sizeof(magic));
  stream.read(reinterpret_cast<char*>(size.data()), sizeof(size));
  constexpr std::int32_t kMaxSize_px = 1 << 14;
  if (!stream || magic != 202021.25F || size[0] < 1 || size[1] < 1 || size[0] > kMaxSize_px ||
      size[1] > kMaxSize_px) {
    throw InputError(fmt::format("{}: not a .flo file", file.string()));
  }
  cv::Mat flow(size[1], size[0], CV_32FC2);
  const std::size_t bytes = flow.total() * flow.elemSize();
  stream.read(flow.ptr<char>(), static_cast<std::streamsize>(bytes));
  if (!stream) throw InputError(fmt::format("{}: truncated .flo file", file.string()));
  std::for_each(flow.begin<cv::Vec2f>(), flow.end<cv::Vec2f>(), [](cv::Vec2f& vector) {
    if (std::max(std::abs(vector[0]), std::abs(vector[1])) > 1e9F) vector = {kUnknown, kUnknown};
  });
  return flow;
}

}  // namespace

std::vector<FlowPair> rendered_pairs(const std::vector<fs::path>& photographs, double noise_grey,
                                     std::uint64_t seed) {
  std::vector<fs::path> grounds = photographs;
  grounds.insert(grounds.begin(), fs::path());
  std::vector<FlowPair> pairs;
  for (const fs::path& ground : grounds) {
    const cv::Mat texture = ground.empty() ? cv::Mat() : read_grey(ground);
    const std::string name = ground.empty() ? "procedural" : ground.stem().string();
    for (const auto& [letter, motion] : {std::pair{"A", kBenchSceneA}, {"B", kBenchSceneB}}) {
      const BenchScene scene = make_bench_scene(motion, texture, seed);
      const FramePair frames = with_noise(scene, noise_grey, seed);
      pairs.push_back(
          {fmt::format("{} {}", letter, name), frames.previous, frames.current, plane_flow(scene)});
    }
  }
  return pairs;
}

std::vector<FlowPair> middlebury_pairs(const fs::path& folder) {
  std::vector<fs::path> pairs_here;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) pairs_here.push_back(entry.path());
  }
  std::sort(pairs_here.begin(), pairs_here.end());
  std::vector<FlowPair> pairs;
  pairs.reserve(pairs_here.size());
  for (const fs::path& pair : pairs_here) {
    pairs.push_back({pair.filename().string(), read_grey(pair / "frame10.png"),
                     read_grey(pair / "frame11.png"), read_flo(pair / "flow10.flo")});
  }
  return pairs;
}

}  // namespace stillkite::bench
