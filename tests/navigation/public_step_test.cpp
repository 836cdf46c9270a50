// Navigator and HoverPilot as a user of the library calls them: ImageView in, Estimate out.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "flow/frame_copies.hpp"
#include "flow/image_mask.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/pilot_step.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kFrames = 20;

// One buffer with padded rows for all images of a flight, as a camera driver has.
class CaptureBuffer {
 public:
  explicit CaptureBuffer(const Camera& camera)
      : pixels_(camera.height_px, camera.width_px + 24, CV_8UC1) {}

  ImageView capture(const cv::Mat& grey) {
    grey.copyTo(pixels_.colRange(0, grey.cols));
    return {pixels_.data, grey.cols, grey.rows, static_cast<std::ptrdiff_t>(pixels_.step)};
  }
  void overwrite() { pixels_.setTo(255); }

 private:
  cv::Mat pixels_;
};

ImageView view_of(const cv::Mat& grey) {
  return {grey.data, grey.cols, grey.rows, static_cast<std::ptrdiff_t>(grey.step)};
}

std::vector<Estimate> fly_from_one_buffer(Navigator navigator, std::size_t frames = kFrames) {
  const test::RenderedFlight& flight = test::rendered_flight();
  CaptureBuffer buffer(flight.record.camera);
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < frames; ++i) {
    const Frame& frame = flight.frames[i];
    estimates.push_back(navigator.step(buffer.capture(frame.grey), frame.stamp));
    buffer.overwrite();
  }
  return estimates;
}

Navigator make_navigator(const EstimatorConfig& estimator,
                         ScaleSource scale = ScaleSource::initial_height) {
  const test::RenderedFlight& flight = test::rendered_flight();
  return {flight.record.camera,
          flight.record.body_from_camera,
          {},
          {flight.truth(0), scale},
          estimator};
}

std::vector<NavigationEstimate> fly_with_own_images(Navigator navigator) {
  const std::vector<Frame>& frames = test::rendered_flight().frames;
  return test::fly(std::move(navigator), {frames.begin(), frames.begin() + kFrames});
}

class PublicStep : public testing::TestWithParam<EstimatorConfig> {};

TEST_P(PublicStep, ReusedCaptureBufferDoesNotChangeTheEstimate) {
  const std::vector<Estimate> estimates = fly_from_one_buffer(make_navigator(GetParam()));
  const std::vector<NavigationEstimate> expected = fly_with_own_images(make_navigator(GetParam()));
  for (std::size_t i = 0; i < kFrames; ++i) {
    const NavigationEstimate aligned = gravity_aligned(expected[i]);
    const Estimate& e = estimates[i];
    EXPECT_EQ(e.verdict, aligned.verdict) << i;
    EXPECT_EQ(e.frame_index, aligned.frame_index) << i;
    EXPECT_EQ(e.world_from_body.coeffs(), aligned.world_from_body.rotation.coeffs()) << i;
    EXPECT_EQ(e.angular_rate_in_camera_rad_s, aligned.twist_in_camera.angular_rate_rad_s) << i;
    ASSERT_EQ(e.metric.has_value(), aligned.scale != ScaleSource::none) << i;
    if (!e.metric) continue;
    EXPECT_EQ(e.metric->position_in_world_m, aligned.world_from_body.translation) << i;
    EXPECT_EQ(e.metric->velocity_in_world_m_s, aligned.velocity_in_world_m_s) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Estimators, PublicStep,
                         testing::Values(EstimatorConfig{Policy::flow, Mode::recommended},
                                         EstimatorConfig{Policy::flow, Mode::paper},
                                         EstimatorConfig{Policy::reference, Mode::recommended},
                                         EstimatorConfig{Policy::reference, Mode::paper},
                                         EstimatorConfig{Policy::best, Mode::recommended},
                                         EstimatorConfig{Policy::fused, Mode::recommended}),
                         [](const auto& estimator) {
                           return std::string(name_of(estimator.param.policy)) + "_" +
                                  std::string(name_of(estimator.param.mode));
                         });

// The same flight with and without a known height: lengths over the initial camera height.
TEST(PublicEstimate, IsInHeightsWithoutASourceOfScale) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const double height_m = (flight.truth(0) * flight.record.body_from_camera).translation.z();
  const auto metric = fly_from_one_buffer(make_navigator({Policy::flow}));
  const auto relative = fly_from_one_buffer(make_navigator({Policy::flow}, ScaleSource::none));
  for (std::size_t i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(metric[i].metric) << i;
    EXPECT_FALSE(metric[i].relative) << i;
    EXPECT_FALSE(relative[i].metric) << i;
    ASSERT_TRUE(relative[i].relative) << i;
    const MetricState& m = *metric[i].metric;
    const RelativeState& r = *relative[i].relative;
    EXPECT_EQ(m.scale, ScaleSource::initial_height);
    EXPECT_LT((height_m * r.position_in_world_heights - m.position_in_world_m).norm(), 1e-9) << i;
    EXPECT_LT((height_m * r.velocity_in_world_heights_s - m.velocity_in_world_m_s).norm(), 1e-9)
        << i;
  }
}

TEST(PublicEstimate, OfTheReferencePolicyHasADirectionAndNoLength) {
  const Estimate last = fly_from_one_buffer(make_navigator({Policy::reference})).back();
  EXPECT_EQ(last.verdict, Verdict::ok);
  EXPECT_FALSE(last.metric);
  EXPECT_FALSE(last.relative);
  ASSERT_TRUE(last.reference);
  EXPECT_EQ(last.reference->displacement, DisplacementKind::direction);
  EXPECT_FALSE(last.reference->displacement_in_reference_m);
  ASSERT_TRUE(last.reference->direction_in_reference);
  EXPECT_NEAR(last.reference->direction_in_reference->norm(), 1, 1e-9);
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto world_from_camera = [&](std::size_t i) {
    return flight.truth(i) * flight.record.body_from_camera;
  };
  const RigidTransform truth = world_from_camera(0).inverse() * world_from_camera(kFrames - 1);
  EXPECT_LT(angle_between_rad(*last.reference->direction_in_reference, truth.translation), 0.05);
}

// Initial tilt error of 5 degrees: the world handed out is vertical, the internal one is not.
TEST(PublicEstimate, IsGravityAligned) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const std::size_t frames = flight.frames.size();
  NavigatorConfig config;
  config.initial_tilt_sigma_rad = 0.1;
  InitialState start = flight.start();
  start.world_from_body.rotation = so3_exp({0.08, -0.05, 0}) * start.world_from_body.rotation;
  const auto make = [&] {
    return Navigator(flight.record.camera, flight.record.body_from_camera, config, start,
                     {.policy = Policy::best});
  };
  const Eigen::Quaterniond& truth = flight.truth(frames - 1).rotation;
  const Estimate aligned = fly_from_one_buffer(make(), frames).back();
  const NavigationEstimate internal = test::fly(make(), flight.frames).back();
  EXPECT_LT(angle_between_rad(aligned.world_from_body, truth), 0.005);
  EXPECT_GT(angle_between_rad(internal.world_from_body.rotation, truth), 0.05);
}

TEST(PublicStepInput, RejectsAnImageThatIsNotOfTheCamera) {
  const Camera& camera = test::rendered_flight().record.camera;
  const cv::Mat grey(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(90));
  const ImageView valid = view_of(grey);
  Navigator navigator = make_navigator({Policy::flow});
  const auto rejects = [&](const ImageView& image) {
    EXPECT_THROW((void)navigator.step(image, {}), InputError);
  };
  rejects({});
  rejects({valid.data, valid.width, valid.height - 1, valid.stride});
  rejects({valid.data, valid.width + 1, valid.height, valid.stride + 1});
  rejects({valid.data, valid.width, valid.height, valid.width - 1});
  EXPECT_EQ(navigator.step(valid, {}).verdict, Verdict::first_frame);
}

TEST(PublicStepInput, AppliesTheMask) {
  const test::RenderedFlight& flight = test::rendered_flight();
  cv::Mat valid_pixels(flight.frames[0].grey.size(), CV_8UC1, cv::Scalar(255));
  valid_pixels.rowRange(0, 120).setTo(0);
  Navigator with_mask(flight.record.camera, flight.record.body_from_camera, {}, flight.start(), {},
                      view_of(valid_pixels));
  Navigator with_masked_frames = flight.navigator();
  const auto mask = std::make_shared<const ImageMask>(valid_pixels.clone());
  valid_pixels.setTo(255);  // the mask is copied
  for (std::size_t i = 0; i < 5; ++i) {
    Frame frame = flight.frames[i];
    const Estimate e = with_mask.step(view_of(frame.grey), frame.stamp);
    frame.mask = mask;
    EXPECT_EQ(e.metric->position_in_world_m,
              with_masked_frames.step(frame).world_from_body.translation);
  }
  EXPECT_THROW(Navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                         {}, ImageView{}),
               InputError);
}

TEST(HoverPilotOnImages, DecidesAsOnFrames) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto make = [&] {
    return HoverPilot(flight.record.camera, flight.record.body_from_camera, {}, {},
                      in_shadow_mode({}), flight.start());
  };
  HoverPilot on_images = make(), on_frames = make();
  CaptureBuffer buffer(flight.record.camera);
  HoldStep last;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const Frame& frame = flight.frames[i];
    const TetheredReadings readings{.now = frame.stamp,
                                    .tether = TetherReading{frame.stamp, {20, 1, 0}}};
    last = on_images.step(buffer.capture(frame.grey), frame.stamp, readings);
    buffer.overwrite();
    const PilotStep expected = on_frames.step(frame, readings);
    EXPECT_EQ(last.decision.position_error_in_station_m,
              expected.decision.position_error_in_station_m)
        << i;
    EXPECT_EQ(last.decision.command.azimuth_rate_rad_s,
              expected.decision.command.azimuth_rate_rad_s)
        << i;
  }
  EXPECT_EQ(last.decision.action, HoldAction::command);
}

// Nothing allocates an image per frame: only a buffer that is still held is not reused.
TEST(FrameCopies, ReusesBuffersThatNobodyHolds) {
  const Camera camera{64, 48, 50, 50, 31.5, 23.5};
  const cv::Mat grey(48, 64, CV_8UC1, cv::Scalar(7));
  FrameCopies copies(camera, std::nullopt);
  const unsigned char* first = copies.copy(view_of(grey), {}).grey.data;
  const Frame held = copies.copy(view_of(grey), {});
  EXPECT_EQ(held.grey.data, first);
  EXPECT_EQ(held.index, 1);
  EXPECT_NE(copies.copy(view_of(grey), {}).grey.data, first);
  EXPECT_EQ(cv::norm(held.grey, grey, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace stillkite
