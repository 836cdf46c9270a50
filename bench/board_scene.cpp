#include "board_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "geometry/angle.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {
namespace {

constexpr int kSide_px = 96;

cv::Mat checkerboard_image(const BoardConfig& board, int side_px) {
  cv::Mat image(board.rows * side_px, board.columns * side_px, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row < board.rows; ++row) {
    for (int column = row % 2; column < board.columns; column += 2) {
      image({column * side_px, row * side_px, side_px, side_px}) = 0;
    }
  }
  return image;
}

cv::Mat charuco_image(const BoardConfig& board, int side_px) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(static_cast<int>(board.dictionary));
  const auto charuco = cv::aruco::CharucoBoard::create(
      board.columns, board.rows, 1, static_cast<float>(board.marker_ratio), dictionary);
  cv::Mat image;
  charuco->draw({board.columns * side_px, board.rows * side_px}, image);
  return image;
}

// Kalibr's layout: tag 0 at the lower left, black squares between the corners of the tags.
cv::Mat aprilgrid_image(const BoardConfig& board, int side_px) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  const int gap_px = static_cast<int>(std::lround(board.tag_spacing_ratio * side_px));
  const int pitch_px = side_px + gap_px;
  cv::Mat image(board.rows * pitch_px + gap_px, board.columns * pitch_px + gap_px, CV_8UC1,
                cv::Scalar(255));
  for (int tag = 0; tag < board.columns * board.rows; ++tag) {
    cv::Mat marker;
    cv::aruco::drawMarker(dictionary, tag, side_px, marker, 2);
    const int row = board.rows - 1 - tag / board.columns;
    marker.copyTo(image(
        {gap_px + tag % board.columns * pitch_px, gap_px + row * pitch_px, side_px, side_px}));
  }
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      image({column * pitch_px, row * pitch_px, gap_px, gap_px}) = 0;
    }
  }
  return image;
}

// Half width and height of the board, m.
Eigen::Vector2d half_extent_m(const BoardConfig& board, const cv::Mat& image) {
  return 0.5 * board.square_m / kSide_px * Eigen::Vector2d(image.cols, image.rows);
}

Scene scene_of(const BoardConfig& board, const cv::Mat& image) {
  constexpr int kMargin = 6;  // the texture repeats mirrored: far from the board
  cv::Mat ground(kMargin * image.rows, kMargin * image.cols, CV_8UC1, cv::Scalar(150));
  const cv::Rect middle((ground.cols - image.cols) / 2, (ground.rows - image.rows) / 2, image.cols,
                        image.rows);
  const int border_px = kSide_px / 2;
  ground({middle.x - border_px, middle.y - border_px, middle.width + 2 * border_px,
          middle.height + 2 * border_px}) = 240;
  cv::Mat(20 + 0.86 * image).copyTo(ground(middle));
  Scene scene;
  scene.ground = std::make_shared<GroundTexture>(ground, board.square_m / kSide_px);
  return scene;
}

// Pose of the board whose centre appears at a pixel.
std::optional<RigidTransform> draw_pose(const BoardScene& scene, const Eigen::Vector2d& half_m,
                                        std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Camera& camera = scene.camera;
  const double part = scene.in_upper_left_half ? 0.5 : 1;
  const auto ray =
      undistort(camera, {uniform(0, part) * camera.width_px, uniform(0, part) * camera.height_px});
  if (!ray) return std::nullopt;
  // the board covers this share of the image width
  const double share = uniform(0.2, 0.7);
  const double distance_m = 2 * half_m.x() * camera.focal_x_px / (share * camera.width_px);
  const double azimuth = uniform(-M_PI, M_PI);
  const double tilt = uniform(0, scene.max_tilt_deg) * kDegree;
  const Eigen::Quaterniond R =
      so3_exp({0, 0, uniform(-M_PI, M_PI)}) *
      so3_exp(tilt * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0)) *
      so3_exp({M_PI, 0, 0});
  return RigidTransform{R, distance_m * ray->homogeneous().normalized()};
}

// Part of the board in the image, of a grid of points over it.
double visible_ratio(const BoardScene& scene, const Eigen::Vector2d& half_m,
                     const RigidTransform& camera_from_board) {
  constexpr int kSteps = 8;
  int visible = 0, count = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j, ++count) {
      const Eigen::Vector3d point(half_m.x() * (2.0 * i / kSteps - 1),
                                  half_m.y() * (2.0 * j / kSteps - 1), 0);
      const auto pixel = project(scene.camera, camera_from_board * point);
      visible += pixel && pixel->x() > 3 && pixel->y() > 3 &&
                 pixel->x() < scene.camera.width_px - 4 && pixel->y() < scene.camera.height_px - 4;
    }
  }
  return static_cast<double>(visible) / count;
}

}  // namespace

cv::Mat board_image(const BoardConfig& board, int side_px) {
  switch (board.type) {
    case BoardType::checkerboard:
      return checkerboard_image(board, side_px);
    case BoardType::charuco:
      return charuco_image(board, side_px);
    case BoardType::aprilgrid:
      return aprilgrid_image(board, side_px);
  }
  return {};
}

std::vector<cv::Mat> render_board_views(const BoardScene& scene, std::uint64_t seed) {
  constexpr int kSupersampling = 3;
  const cv::Mat image = board_image(scene.board, kSide_px);
  const Eigen::Vector2d half_m = half_extent_m(scene.board, image);
  const Scene ground = scene_of(scene.board, image);
  const Renderer renderer(scene.camera, kSupersampling);
  const bool is_whole = scene.board.type == BoardType::checkerboard;
  std::mt19937_64 random(seed);
  std::vector<cv::Mat> images;
  while (static_cast<int>(images.size()) < scene.views) {
    const auto pose = draw_pose(scene, half_m, random);
    if (!pose || visible_ratio(scene, half_m, *pose) < (is_whole ? 1 : 0.3)) continue;
    const RigidTransform world_from_camera = pose->inverse();
    if (!(world_from_camera.translation.z() > 0.3 * pose->translation.norm())) continue;
    cv::Mat irradiance = renderer.render(ground, world_from_camera);
    cv::GaussianBlur(irradiance, irradiance, {}, scene.blur_px);
    images.push_back(
        develop(irradiance, {.noise_grey = scene.noise_grey}, seed * 1000 + images.size()));
  }
  return images;
}

}  // namespace stillkite
