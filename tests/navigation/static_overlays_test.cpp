#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/image_mask.hpp"
#include "tests/navigation/rendered_flight.hpp"

// What is fixed to the camera: legs on a fifth of the image, with bolts on them.

namespace stillkite {
namespace {

using test::RenderedFlight;

const RenderedFlight& flight() {
  static const RenderedFlight made = [] {
    SimulationConfig config = test::small_flight(3);
    config.flight.duration_s = 4;
    config.flight.forward_m = 40;
    return test::film(config);
  }();
  return made;
}

const cv::Rect kLegs[] = {{0, 120, 100, 240}, {540, 120, 100, 240}};

cv::Mat with_legs(const cv::Mat& image) {
  cv::Mat painted = image.clone();
  for (const cv::Rect& leg : kLegs) {
    cv::rectangle(painted, leg, 45, -1);
    for (int y = leg.y + 20; y < leg.y + leg.height; y += 50) {
      for (int x = leg.x + 20; x < leg.x + leg.width; x += 30) {
        cv::circle(painted, {x, y}, 8, 200, -1, cv::LINE_AA);
      }
    }
  }
  return painted;
}

std::shared_ptr<const ImageMask> legs_mask() {
  const cv::Mat& image = flight().frames.front().grey;
  cv::Mat shows_world(image.size(), CV_8U, cv::Scalar(255));
  for (const cv::Rect& leg : kLegs) shows_world(leg) = 0;
  return std::make_shared<const ImageMask>(shows_world);
}

std::vector<NavigationEstimate> fly_with_legs(Policy policy,
                                              const std::shared_ptr<const ImageMask>& mask) {
  std::vector<Frame> frames = flight().frames;
  for (Frame& frame : frames) {
    frame.grey = with_legs(frame.grey);
    frame.mask = mask;
  }
  return test::fly({flight().record.camera,
                    flight().record.body_from_camera,
                    {},
                    flight().start(),
                    {.policy = policy}},
                   frames);
}

// Of the way since a frame, m.
double error_since_m(const std::vector<NavigationEstimate>& estimates, std::size_t from) {
  const auto way = [&](const RigidTransform& a, const RigidTransform& b) -> Eigen::Vector3d {
    return b.translation - a.translation;
  };
  const std::size_t last = estimates.size() - 1;
  return (way(estimates[from].world_from_body, estimates[last].world_from_body) -
          way(flight().truth(from), flight().truth(last)))
      .norm();
}

class Legs : public testing::TestWithParam<Policy> {};

TEST_P(Legs, AreFoundOnTheWay) {
  const std::vector<NavigationEstimate> estimates = fly_with_legs(GetParam(), nullptr);
  EXPECT_EQ(estimates.front().hidden_ratio, 0);
  EXPECT_GT(estimates.back().hidden_ratio, 0.03);
  EXPECT_LT(estimates.back().hidden_ratio, 0.25);
  EXPECT_LT(error_since_m(estimates, 50), 0.1);
}

TEST_P(Legs, DoNoHarmBehindAMask) {
  const std::vector<NavigationEstimate> estimates = fly_with_legs(GetParam(), legs_mask());
  EXPECT_NEAR(estimates.front().hidden_ratio, 0.208, 0.01);
  EXPECT_LT(error_since_m(estimates, 0), 0.1);
  for (const NavigationEstimate& e : estimates)
    EXPECT_TRUE(is_measured(e.verdict)) << e.frame_index;
}

INSTANTIATE_TEST_SUITE_P(StaticOverlays, Legs,
                         testing::Values(Policy::flow, Policy::best, Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

TEST(StaticOverlays, AMaskOfAnotherSizeIsRefused) {
  Navigator navigator = flight().navigator();
  Frame frame = flight().frames.front();
  frame.mask = std::make_shared<const ImageMask>(cv::Mat(10, 10, CV_8U, cv::Scalar(255)));
  EXPECT_THROW(navigator.step(frame), InputError);
}

TEST(StaticOverlays, AFlightWithoutThemHidesNothing) {
  const auto estimates = test::fly(flight().navigator(), flight().frames);
  for (const NavigationEstimate& e : estimates) EXPECT_EQ(e.hidden_ratio, 0) << e.frame_index;
}

// The reference alone learns of no motion, but leaves out what a mask hides, however it follows.
TEST(StaticOverlays, AMaskHidesTheReferencesFeatures) {
  for (const Association association :
       {Association::windows, Association::opencv, Association::matching}) {
    NavigatorConfig config;
    config.reference.association = association;
    Navigator navigator(flight().record.camera, flight().record.body_from_camera, config,
                        flight().start(), {.policy = Policy::reference});
    const auto mask = legs_mask();
    for (std::size_t i = 0; i < 5; ++i) {
      Frame frame = flight().frames[i];
      frame.grey = with_legs(frame.grey);
      if (i > 0) frame.mask = mask;  // the legs have features in the reference
      const NavigationEstimate estimate = navigator.step(frame);
      EXPECT_TRUE(is_measured(estimate.verdict)) << name_of(association);
      for (const WindowFlow& window : navigator.windows()) {
        EXPECT_EQ(mask->hidden_ratio(window.centre_px.x(), window.centre_px.y(), 1, 1), 0)
            << name_of(association);
      }
    }
  }
}

}  // namespace
}  // namespace stillkite
