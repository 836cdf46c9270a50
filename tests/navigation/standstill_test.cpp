#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/scene/scenes.hpp"
#include "tests/navigation/rendered_flight.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite {
namespace {

using test::rendered_flight;

constexpr int kAtRest = 25;          // frames, 1 s
constexpr double kMaxSigma = 0.005;  // m/s per metre of height

cv::Mat with_noise(const cv::Mat& image, int seed) {
  cv::Mat noise(image.size(), CV_32F), out;
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  random.fill(noise, cv::RNG::NORMAL, 0, 1);
  image.convertTo(out, CV_32F);
  out += noise;
  out.convertTo(out, CV_8U);
  return out;
}

double max_velocity_sigma_m_s(const NavigationEstimate& e) {
  return std::sqrt(e.twist_covariance.diagonal().head<3>().maxCoeff());
}

class Standstill : public testing::TestWithParam<Policy> {};

TEST_P(Standstill, IsMeasuredBeforeTheFlight) {
  const auto& flight = rendered_flight();
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                      {.policy = GetParam()});
  const double height_m = flight.truth(0).translation.z();
  for (int i = 0; i < kAtRest; ++i) {
    const NavigationEstimate e =
        navigator.step({from_seconds(0.04 * i), i, with_noise(flight.frames[0].grey, i)});
    EXPECT_EQ(e.verdict == Verdict::still, i >= 13) << i;
    if (e.verdict != Verdict::still) continue;
    EXPECT_EQ(e.twist_in_camera.vector().norm(), 0);
    EXPECT_LT(max_velocity_sigma_m_s(e), kMaxSigma * height_m);
    EXPECT_LT((e.world_from_body.translation - flight.truth(0).translation).norm(), 0.05);
  }
  for (std::size_t i = 1; i < flight.frames.size(); ++i) {
    const int frame = kAtRest + static_cast<int>(i);
    const NavigationEstimate e =
        navigator.step({from_seconds(0.04 * frame), frame, flight.frames[i].grey});
    EXPECT_EQ(e.verdict, Verdict::ok) << i;
    if (GetParam() == Policy::reference) continue;
    EXPECT_LT((e.world_from_body.translation - flight.truth(i).translation).norm(), 0.1) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, Standstill,
                         testing::Values(Policy::flow, Policy::reference, Policy::best),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

// The plane does not explain the images of a room, but rest does.
TEST(Standstill, IsMeasuredOverAnyScene) {
  const RigidTransform mount = camera_raised_forward(80);
  const PatchScene scene = make_room(5);
  const PatchRenderer renderer(small_camera(), 2);
  const auto image = [&](double forward_m, int seed) {
    const RigidTransform world_from_body{Eigen::Quaterniond::Identity(), {forward_m, 0, 1.8}};
    return develop(renderer.render(scene, world_from_body * mount), {.noise_grey = 1.5}, seed);
  };
  Navigator navigator(small_camera(), mount, {},
                      {{Eigen::Quaterniond::Identity(), {0, 0, 1.8}}, ScaleSource::initial_height});
  int not_flat = 0;
  double forward_m = 0;
  for (int i = 0; i < 60; ++i) {
    if (i < 30) forward_m += 0.01;
    const NavigationEstimate e = navigator.step({from_seconds(i / 30.0), i, image(forward_m, i)});
    not_flat += e.verdict == Verdict::not_flat ? 1 : 0;
    if (i < 30) {
      EXPECT_NE(e.verdict, Verdict::still) << i;
    }
    if (i < 46) continue;
    EXPECT_EQ(e.verdict, Verdict::still) << i;
    EXPECT_EQ(e.twist_in_camera.velocity_m_s.norm(), 0);
    EXPECT_LT(max_velocity_sigma_m_s(e), kMaxSigma * 1.8);
  }
  EXPECT_GT(not_flat, 10);
}

// Papers' procedures have no such verdict.
TEST(Standstill, IsNotPartOfThePapers) {
  const auto& flight = rendered_flight();
  for (const Policy policy : {Policy::flow, Policy::reference}) {
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = policy, .mode = Mode::paper});
    for (int i = 0; i < kAtRest; ++i) {
      const NavigationEstimate e =
          navigator.step({from_seconds(0.04 * i), i, with_noise(flight.frames[0].grey, i)});
      EXPECT_NE(e.verdict, Verdict::still);
    }
  }
}

}  // namespace
}  // namespace stillkite
