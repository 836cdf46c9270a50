#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "simulation/scene/scenes.hpp"
#include "tests/simulation/render/ground_truth.hpp"

namespace stillkite {
namespace {

using test::small_camera;

RigidTransform forward_pose(double yaw_deg, double raised_deg, const Eigen::Vector3d& position) {
  return RigidTransform{to_quaternion({.yaw_rad = yaw_deg * kDegree}), position} *
         camera_raised_forward(raised_deg);
}

std::shared_ptr<const GroundTexture> uniform_texture(double grey) {
  return std::make_shared<GroundTexture>(cv::Mat(16, 16, CV_8UC1, cv::Scalar(grey)), 0.1);
}

// Vertical patch that faces -x; not mirrored for a camera that points along +x.
Patch vertical_patch(const Eigen::Vector3d& middle, double width_m, double height_m,
                     const std::shared_ptr<const GroundTexture>& texture) {
  return {.corner_in_world_m = middle + Eigen::Vector3d(0, width_m / 2, height_m / 2),
          .right_in_world_m = {0, -width_m, 0},
          .down_in_world_m = {0, 0, -height_m},
          .texture = texture};
}

constexpr DistortionModel kLenses[] = {DistortionModel::none, DistortionModel::radial_tangential,
                                       DistortionModel::equidistant};

double value_at(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  cv::Mat value;
  cv::getRectSubPix(image, {1, 1}, {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
                    value);
  return value.at<float>(0, 0);
}

// First-order distance from a pixel to the isoline of a grey value, along the gradient.
double distance_to_isoline_px(const cv::Mat& image, double grey, const Eigen::Vector2d& pixel) {
  const auto slope = [&](const Eigen::Vector2d& half_step) {
    return value_at(image, pixel + half_step) - value_at(image, pixel - half_step);
  };
  const double gradient = std::hypot(slope({0.5, 0}), slope({0, 0.5}));
  return std::abs(value_at(image, pixel) - grey) / gradient;
}

// Four squares in an oblique view: points on their common edges appear at their projections. The
// edges are blurred for subpixel localization; the mean grey lies on the sharp edge.
TEST(PatchRenderer, RendersEdgesAtTheirProjection) {
  constexpr int kSquare = 200;
  cv::Mat squares(2 * kSquare, 2 * kSquare, CV_8UC1, cv::Scalar(30));
  squares(cv::Rect(0, 0, kSquare, kSquare)).setTo(220);
  squares(cv::Rect(kSquare, kSquare, kSquare, kSquare)).setTo(220);
  cv::GaussianBlur(squares, squares, {}, 6);
  const Patch patch =
      vertical_patch({6, 0.3, 1.2}, 3.9, 3.9, std::make_shared<GroundTexture>(squares, 0.01));
  int points = 0;
  for (const DistortionModel lens : kLenses) {
    const Camera camera = small_camera(lens);
    const PatchRenderer renderer(camera, 4);
    for (const double yaw_deg : {-20.0, -9.0, 0.0, 13.0, 20.0}) {
      const RigidTransform pose = forward_pose(yaw_deg, 80, {0.4, 1.1, 1.5});
      const cv::Mat image = renderer.render({.patches = {patch}, .background_grey = 120}, pose);
      for (const double along_texels : {60.0, 100.0, 150.0, 250.0, 300.0, 340.0}) {
        for (const Eigen::Vector2d& texel : {Eigen::Vector2d(along_texels, kSquare - 0.5),
                                             Eigen::Vector2d(kSquare - 0.5, along_texels)}) {
          const Eigen::Vector3d point =
              patch.corner_in_world_m + 0.01 * Eigen::Vector3d(0, -texel.x(), -texel.y());
          const Eigen::Vector2d pixel = *project(camera, pose.inverse() * point);
          if (pixel.x() < 2 || pixel.x() > camera.width_px - 3) continue;
          EXPECT_LT(distance_to_isoline_px(image, 125, pixel), 0.05) << name_of(lens);
          ++points;
        }
      }
    }
  }
  EXPECT_GT(points, 150);
}

// In a room with a different grey value per patch, every pixel has the grey value of the first
// patch along its analytic ray.
TEST(PatchRenderer, RendersNearestPatchInEveryPixel) {
  PatchScene scene = make_room(3);
  for (std::size_t k = 0; k < scene.patches.size(); ++k) {
    scene.patches[k].texture = uniform_texture(static_cast<double>(k + 1));
  }
  for (const DistortionModel lens : kLenses) {
    const Camera camera = small_camera(lens);
    const PatchRenderer renderer(camera, 1);
    for (const RigidTransform& pose :
         {forward_pose(0, 75, {0, 0, 3}), forward_pose(140, 60, {2, 1, 2.2}),
          forward_pose(-80, 20, {-1, 2, 3.5})}) {
      const cv::Mat image = renderer.render(scene, pose);
      int edges = 0;
      for (int row = 0; row < camera.height_px; ++row) {
        for (int column = 0; column < camera.width_px; ++column) {
          const Ray ray = ray_of(pose, *undistort(camera, {double(column), double(row)}));
          const std::optional<PatchHit> hit = first_hit(scene, ray);
          ASSERT_TRUE(hit);
          const auto number = static_cast<float>(hit->patch - scene.patches.data() + 1);
          // single precision may differ on an edge
          if (std::abs(image.at<float>(row, column) - number) > 1e-3) ++edges;
        }
      }
      EXPECT_LE(edges, 3) << name_of(lens);
    }
  }
}

// A wall that covers its tiles uses a different code path than a wall behind slats. Both render the
// visible wall identically.
TEST(PatchRenderer, CoveredAndSharedTilesAgree) {
  cv::Mat grey = procedural_ground(600, 400, 5);
  cv::GaussianBlur(grey, grey, {}, 1.5);
  PatchScene scene{
      .patches = {vertical_patch({5, 0, 2}, 40, 20, std::make_shared<GroundTexture>(grey, 0.02))}};
  PatchScene with_slats = scene;
  for (double z = 0.5; z < 3.5; z += 0.08) {
    with_slats.patches.push_back(vertical_patch({1, 0, z}, 8, 0.003, uniform_texture(0)));
  }
  for (const DistortionModel lens : kLenses) {
    const Camera camera = small_camera(lens);
    const PatchRenderer renderer(camera, 1);
    const RigidTransform pose = forward_pose(35, 88, {0, 0, 2});
    const cv::Mat alone = renderer.render(scene, pose);
    const cv::Mat shared = renderer.render(with_slats, pose);
    int compared = 0;
    int different = 0;
    for (int row = 0; row < camera.height_px; ++row) {
      for (int column = 0; column < camera.width_px; ++column) {
        const auto bearing = undistort(camera, {double(column), double(row)});
        const std::optional<PatchHit> hit = first_hit(with_slats, ray_of(pose, *bearing));
        if (!hit || hit->patch != with_slats.patches.data()) continue;
        ++compared;
        if (std::abs(alone.at<float>(row, column) - shared.at<float>(row, column)) > 0.05) {
          ++different;
        }
      }
    }
    EXPECT_GT(compared, camera.width_px * camera.height_px / 2) << name_of(lens);
    EXPECT_LE(different, 5) << name_of(lens);
  }
}

// At distances where a sample is smaller than a texel, a pixel has the grey value of its point.
TEST(PatchRenderer, RendersTextureAtFinestLevel) {
  cv::Mat grey = procedural_ground(300, 200, 7);
  cv::GaussianBlur(grey, grey, {}, 1.5);
  const auto texture = std::make_shared<GroundTexture>(grey, 0.05);
  // the second patch is larger than its texture: mirrored repetition
  const PatchScene scene{.patches = {vertical_patch({4, 2, 1}, 5, 4, texture),
                                     vertical_patch({7, -20, 3}, 60, 25, texture)}};
  for (const DistortionModel lens : kLenses) {
    const Camera camera = small_camera(lens);
    const RigidTransform pose = forward_pose(-20, 95, {0, 0, 2});
    const cv::Mat image = PatchRenderer(camera, 1).render(scene, pose);
    int compared = 0;
    for (int row = 0; row < camera.height_px; row += 3) {
      for (int column = 0; column < camera.width_px; column += 3) {
        const std::optional<PatchHit> hit =
            first_hit(scene, ray_of(pose, *undistort(camera, {double(column), double(row)})));
        if (!hit) {
          ASSERT_EQ(image.at<float>(row, column), 200.0F);
          continue;
        }
        if (std::pow(hit->depth, 3) / 4 > std::pow(0.05 * 168, 2)) continue;
        ++compared;
        ASSERT_NEAR(image.at<float>(row, column), grey_at(*hit->patch, hit->point_in_world_m), 0.1);
      }
    }
    EXPECT_GT(compared, 1000);
  }
}

// Squares of one texel are resolved at a short distance and averaged at a long distance.
TEST(PatchRenderer, AveragesDistantTexture) {
  cv::Mat squares(1024, 1024, CV_8UC1);
  for (int v = 0; v < squares.rows; ++v) {
    for (int u = 0; u < squares.cols; ++u) squares.at<std::uint8_t>(v, u) = (u + v) % 2 ? 210 : 30;
  }
  const auto texture = std::make_shared<GroundTexture>(squares, 0.02);
  const auto contrast_at = [&](double distance_m) {
    const cv::Mat image =
        PatchRenderer(small_camera(), 2)
            .render({.patches = {vertical_patch({distance_m, 0, 0}, 20, 20, texture)}},
                    forward_pose(0, 90, {0, 0, 0}));
    cv::Scalar mean, deviation;
    cv::meanStdDev(image(cv::Rect(100, 62, 40, 40)), mean, deviation);
    EXPECT_NEAR(mean[0], 120, 3);
    return deviation[0];
  };
  EXPECT_NEAR(contrast_at(0.5), 90.0 / 3, 2);  // bilinear interpolation of +-90
  EXPECT_LT(contrast_at(14), 4);
}

// A grey ramp has the same position on every pyramid level.
TEST(PatchRenderer, PyramidLevelsAreAligned) {
  cv::Mat ramp(256, 256, CV_8UC1);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u) ramp.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(u);
  }
  const Camera camera = small_camera();
  for (const double texel_m : {0.05, 0.02, 0.008}) {
    const PatchScene scene{
        .patches = {vertical_patch({8, 0, 0}, 255 * texel_m, 255 * texel_m,
                                   std::make_shared<GroundTexture>(ramp, texel_m))}};
    const RigidTransform pose = forward_pose(5, 90, {0, 0.2, 0});
    const cv::Mat image = PatchRenderer(camera, 1).render(scene, pose);
    for (const double u : {70.0, 110.5, 180.25}) {
      const Eigen::Vector3d point =
          scene.patches[0].corner_in_world_m + texel_m * Eigen::Vector3d(0, -u, -128);
      const Eigen::Vector2d at = *project(camera, pose.inverse() * point);
      cv::Mat patch;
      cv::getRectSubPix(image, {1, 1}, {static_cast<float>(at.x()), static_cast<float>(at.y())},
                        patch);
      EXPECT_NEAR(patch.at<float>(0, 0), u, 0.5) << texel_m;
    }
  }
}

// Image displacement, in pixels, of sine waves along both axes of a frontal patch at `distance_m`
// from their true position, by least squares.
Eigen::Vector2d wave_shift_px(double distance_m) {
  constexpr double kTexel_m = 0.02;
  constexpr double kWave_texels = 7;
  constexpr double kRate = 2 * std::numbers::pi / kWave_texels;
  cv::Mat waves(700, 700, CV_8UC1);
  for (int v = 0; v < waves.rows; ++v) {
    for (int u = 0; u < waves.cols; ++u) {
      waves.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
          128 + 60 * std::sin(kRate * u) + 60 * std::sin(kRate * v));
    }
  }
  const Patch patch =
      vertical_patch({distance_m, 0, 0}, 14, 14, std::make_shared<GroundTexture>(waves, kTexel_m));
  const Camera camera = small_camera();
  const RigidTransform pose = forward_pose(0, 90, {0, 0, 0});
  const cv::Mat image = PatchRenderer(camera, 4).render({.patches = {patch}}, pose);
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5d right = Vector5d::Zero();
  for (int row = 30; row < 130; ++row) {
    for (int column = 60; column < 180; ++column) {
      const Ray ray = ray_of(pose, *undistort(camera, {double(column), double(row)}));
      const Eigen::Vector3d point =
          distance_m / ray.direction_in_world.x() * ray.direction_in_world;
      const Eigen::Vector3d from_corner = (point - patch.corner_in_world_m) / kTexel_m;
      const double u = -kRate * from_corner.y();
      const double v = -kRate * from_corner.z();
      Vector5d waves_there;
      waves_there << 1, std::sin(u), std::cos(u), std::sin(v), std::cos(v);
      normal += waves_there * waves_there.transpose();
      right += waves_there * image.at<float>(row, column);
    }
  }
  const Vector5d wave = normal.ldlt().solve(right);
  const double px_a_texel = kTexel_m * camera.focal_x_px / distance_m;
  return px_a_texel / kRate *
         Eigen::Vector2d(std::atan2(wave[2], wave[1]), std::atan2(wave[4], wave[3]));
}

// Between two pyramid levels, part of a pixel's samples use the finer one. Detail of the finer
// level must not be displaced towards these samples.
TEST(PatchRenderer, HasNoShiftBetweenPyramidLevels) {
  for (double distance_m = 3.5; distance_m < 7; distance_m *= 1.07) {
    EXPECT_LT(wave_shift_px(distance_m).cwiseAbs().maxCoeff(), 0.003) << distance_m;
  }
}

// An exposure is the mean of its instants.
TEST(PatchRenderer, MotionBlurAveragesInstants) {
  cv::Mat grey = procedural_ground(400, 300, 9);
  cv::GaussianBlur(grey, grey, {}, 2);
  const PatchScene scene{
      .patches = {vertical_patch({6, 0, 1}, 12, 9, std::make_shared<GroundTexture>(grey, 0.04))}};
  const PatchRenderer renderer(small_camera(), 2);
  const RigidTransform opening = forward_pose(0, 90, {0, 0, 1});
  const RigidTransform closing = forward_pose(1.5, 90, {0, 0, 1});  // 4 pixels
  cv::Mat mean(160, 237, CV_32FC1, cv::Scalar(0));
  for (int k = 0; k < 4; ++k) {
    mean += renderer.render(scene, interpolate(opening, closing, (k + 0.5) / 4)) / 4;
  }
  const cv::Mat blurred = renderer.render(scene, Shutter{opening, closing, 4});
  const double area = static_cast<double>(blurred.total());
  EXPECT_LT(cv::norm(blurred, mean) / std::sqrt(area), 1);
  EXPECT_GT(cv::norm(blurred, renderer.render(scene, opening)) / std::sqrt(area), 3);
  EXPECT_EQ(cv::norm(renderer.render(scene, Shutter{opening, opening, 4}),
                     renderer.render(scene, opening), cv::NORM_INF),
            0);
  EXPECT_THROW((void)renderer.render(scene, Shutter{opening, closing, 3}), InputError);
}

// A vertical or horizontal edge crosses the samples of a pixel one at a time.
TEST(PatchRenderer, EdgeMotionChangesPixelsInEqualSteps) {
  const PatchScene scene{.patches = {vertical_patch({5, 0, 0}, 4, 4, uniform_texture(200))},
                         .background_grey = 0};
  const Camera camera = small_camera();
  const PatchRenderer renderer(camera, 2);
  // length of the patch in pixels in the first half of a row or column
  const auto covered_px = [&](const cv::Mat& line) {
    return cv::sum(line(cv::Range(0, static_cast<int>(line.total()) / 2), cv::Range::all()))[0] /
           200;
  };
  constexpr int kSteps = 40;
  for (const bool is_horizontal : {true, false}) {
    const double pixel_m = 5 / (is_horizontal ? camera.focal_y_px : camera.focal_x_px);
    const Eigen::Vector3d displacement(0, is_horizontal ? 0 : -pixel_m,
                                       is_horizontal ? pixel_m : 0);
    std::vector<double> covered;
    for (int step = 0; step <= kSteps; ++step) {
      const cv::Mat image =
          renderer.render(scene, forward_pose(0, 90, step * displacement / kSteps));
      covered.push_back(covered_px(is_horizontal ? image.col(camera.width_px / 2).clone()
                                                 : image.row(camera.height_px / 2).t()));
    }
    double max_change = 0;
    for (int step = 0; step < kSteps; ++step) {
      max_change = std::max(max_change, std::abs(covered[step + 1] - covered[step]));
    }
    EXPECT_NEAR(std::abs(covered.back() - covered.front()), 1, 1e-3);
    EXPECT_NEAR(max_change, 0.25, 1e-3);
  }
}

TEST(PatchRenderer, IsDeterministicAndIndependentOfVectorWidth) {
  const PatchScene room = make_room(5);
  const RigidTransform pose = forward_pose(10, 75, {0.5, 0, 3});
  const PatchRenderer renderer(small_camera(DistortionModel::radial_tangential), 2);
  const cv::Mat once = renderer.render(room, pose);
  EXPECT_EQ(cv::norm(once, renderer.render(room, pose), cv::NORM_INF), 0);

  hwy::DisableTargets(~std::int64_t{HWY_STATIC_TARGET});
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const cv::Mat narrow = renderer.render(room, pose);
  hwy::DisableTargets(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_LT(cv::norm(once, narrow, cv::NORM_L1) / static_cast<double>(once.total()), 0.01);
}

}  // namespace
}  // namespace stillkite
