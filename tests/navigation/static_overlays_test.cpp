#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flow/image_mask.hpp"
#include "tests/navigation/rendered_flight.hpp"

// Static overlays: landing gear with bolts on a fifth of the image.

namespace stillkite {
namespace {

using test::RenderedFlight;

const RenderedFlight& flight() {
  static const RenderedFlight made = [] {
    SimulationConfig config = test::small_flight(3);
    config.flight.duration_s = 4;
    config.flight.forward_m = 40;
    return test::render_flight(config);
  }();
  return made;
}

const cv::Rect kLandingGear[] = {{0, 120, 100, 240}, {540, 120, 100, 240}};

cv::Mat with_landing_gear(const cv::Mat& image) {
  cv::Mat painted = image.clone();
  for (const cv::Rect& strut : kLandingGear) {
    cv::rectangle(painted, strut, 45, -1);
    for (int y = strut.y + 20; y < strut.y + strut.height; y += 50) {
      for (int x = strut.x + 20; x < strut.x + strut.width; x += 30) {
        cv::circle(painted, {x, y}, 8, 200, -1, cv::LINE_AA);
      }
    }
  }
  return painted;
}

std::shared_ptr<const ImageMask> landing_gear_mask() {
  const cv::Mat& image = flight().frames.front().grey;
  cv::Mat valid_pixels(image.size(), CV_8U, cv::Scalar(255));
  for (const cv::Rect& strut : kLandingGear) valid_pixels(strut) = 0;
  return std::make_shared<const ImageMask>(valid_pixels);
}

std::vector<NavigationEstimate> fly_with_landing_gear(
    Policy policy, const std::shared_ptr<const ImageMask>& mask) {
  std::vector<Frame> frames = flight().frames;
  for (Frame& frame : frames) {
    frame.grey = with_landing_gear(frame.grey);
    frame.mask = mask;
  }
  return test::fly({flight().record.camera,
                    flight().record.body_from_camera,
                    {},
                    flight().start(),
                    {.policy = policy}},
                   frames);
}

// Error of the displacement since frame `from`.
double displacement_error_m(const std::vector<NavigationEstimate>& estimates, std::size_t from) {
  const auto displacement = [&](const RigidTransform& a,
                                const RigidTransform& b) -> Eigen::Vector3d {
    return b.translation - a.translation;
  };
  const std::size_t last = estimates.size() - 1;
  return (displacement(estimates[from].world_from_body, estimates[last].world_from_body) -
          displacement(flight().truth(from), flight().truth(last)))
      .norm();
}

class LandingGear : public testing::TestWithParam<Policy> {};

TEST_P(LandingGear, IsDetectedInFlight) {
  const std::vector<NavigationEstimate> estimates = fly_with_landing_gear(GetParam(), nullptr);
  EXPECT_EQ(estimates.front().masked_ratio, 0);
  EXPECT_GT(estimates.back().masked_ratio, 0.03);
  EXPECT_LT(estimates.back().masked_ratio, 0.25);
  // `best` keeps the attitude error of the reference estimator before the detection
  const double max_error_m = GetParam() == Policy::best ? 0.3 : 0.1;
  EXPECT_LT(displacement_error_m(estimates, 50), max_error_m);
}

TEST_P(LandingGear, IsHarmlessBehindMask) {
  const std::vector<NavigationEstimate> estimates =
      fly_with_landing_gear(GetParam(), landing_gear_mask());
  EXPECT_NEAR(estimates.front().masked_ratio, 0.208, 0.01);
  EXPECT_LT(displacement_error_m(estimates, 0), 0.1);
  for (const NavigationEstimate& e : estimates)
    EXPECT_TRUE(is_measured(e.verdict)) << e.frame_index;
}

INSTANTIATE_TEST_SUITE_P(StaticOverlays, LandingGear,
                         testing::Values(Policy::flow, Policy::best, Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

TEST(StaticOverlays, RejectsMaskOfWrongSize) {
  Navigator navigator = flight().navigator();
  Frame frame = flight().frames.front();
  frame.mask = std::make_shared<const ImageMask>(cv::Mat(10, 10, CV_8U, cv::Scalar(255)));
  EXPECT_THROW(navigator.step(frame), InputError);
}

TEST(StaticOverlays, FlightWithoutOverlaysMasksNothing) {
  const auto estimates = test::fly(flight().navigator(), flight().frames);
  for (const NavigationEstimate& e : estimates) EXPECT_EQ(e.masked_ratio, 0) << e.frame_index;
}

// Overlay detection needs the flow; the reference estimator alone applies the mask, for every
// association method.
TEST(StaticOverlays, MaskRemovesReferenceFeatures) {
  for (const Association association :
       {Association::windows, Association::opencv, Association::matching}) {
    NavigatorConfig config;
    config.reference.association = association;
    Navigator navigator(flight().record.camera, flight().record.body_from_camera, config,
                        flight().start(), {.policy = Policy::reference});
    const auto mask = landing_gear_mask();
    for (std::size_t i = 0; i < 5; ++i) {
      Frame frame = flight().frames[i];
      frame.grey = with_landing_gear(frame.grey);
      if (i > 0) frame.mask = mask;  // the reference has features on the landing gear
      const NavigationEstimate estimate = navigator.step(frame);
      EXPECT_TRUE(is_measured(estimate.verdict)) << name_of(association);
      for (const WeightedFlow& vector : navigator.flow_vectors()) {
        EXPECT_EQ(mask->masked_ratio(vector.centre_px.x(), vector.centre_px.y(), 1, 1), 0)
            << name_of(association);
      }
    }
  }
}

}  // namespace
}  // namespace stillkite
