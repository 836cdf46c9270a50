#include "navigation/navigator.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "flow/image_mask.hpp"
#include "flow/static_overlay_detector.hpp"
#include "navigation/best_navigator.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/fused_navigator.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/paper_navigator.hpp"
#include "navigation/reference_navigator.hpp"

namespace stillkite {
namespace {

using Method = std::variant<KeyframeNavigator, PaperNavigator, ReferenceNavigator, BestNavigator,
                            FusedNavigator>;

Method make_method(const Camera& camera, const RigidTransform& body_from_camera,
                   const NavigatorConfig& config, const InitialState& initial,
                   const EstimatorConfig& estimator) {
  const double height_m = (initial.world_from_body * body_from_camera).translation.z();
  if (!(height_m > 0)) {
    throw InputError(fmt::format(
        "navigator: the camera starts at the height {:.4g}; it must be over the ground, z > 0",
        height_m));
  }
  if (!(camera.width_px > 0 && camera.height_px > 0 && camera.focal_x_px > 0 &&
        camera.focal_y_px > 0)) {
    throw InputError("navigator: the camera's size and focal lengths must be positive");
  }
  if (estimator.policy == Policy::reference) {
    return ReferenceNavigator(camera, body_from_camera, config, initial, estimator.mode);
  }
  if (estimator.policy == Policy::best) {
    return BestNavigator(camera, body_from_camera, config, initial, estimator.mode);
  }
  if (estimator.policy == Policy::fused) {
    return FusedNavigator(camera, body_from_camera, config, initial);
  }
  if (estimator.mode == Mode::paper)
    return PaperNavigator(camera, body_from_camera, config, initial);
  return KeyframeNavigator(camera, body_from_camera, config, initial);
}

void check_image(const Frame& frame, const Camera& camera) {
  const cv::Mat& grey = frame.grey;
  if (frame.mask && frame.mask->shows_world().size() != grey.size()) {
    throw InputError(fmt::format("frame {}: {}x{} pixels, its mask {}x{}", frame.index, grey.cols,
                                 grey.rows, frame.mask->shows_world().cols,
                                 frame.mask->shows_world().rows));
  }
  if (grey.type() == CV_8UC1 && grey.cols == camera.width_px && grey.rows == camera.height_px) {
    return;
  }
  throw InputError(fmt::format(
      "frame {}: {}x{} pixels, {} bytes each; the camera has {}x{} of one byte", frame.index,
      grey.cols, grey.rows, grey.elemSize(), camera.width_px, camera.height_px));
}

// A range finder without an echo may tell infinity. Inertial readings are looked at one by one.
SensorReadings drop_non_finite(SensorReadings readings) {
  const auto drop = [](auto& reading, bool is_number) {
    if (!is_number) reading.reset();
  };
  if (readings.height_m) drop(readings.height_m, std::isfinite(*readings.height_m));
  if (readings.attitude) drop(readings.attitude, readings.attitude->coeffs().allFinite());
  if (readings.acceleration) drop(readings.acceleration, readings.acceleration->allFinite());
  if (auto& rate = readings.mean_angular_rate_in_body_rad_s) drop(rate, rate->allFinite());
  return readings;
}

}  // namespace

struct Navigator::State {
  Camera camera;
  FrameClock clock;
  Method method;
  StaticOverlayDetector fixtures;
  double image_speed_px_s = 0;  // by the frame before
};

Navigator::Navigator(const Camera& camera, const RigidTransform& body_from_camera,
                     const NavigatorConfig& config, const InitialState& initial,
                     const EstimatorConfig& estimator)
    : state_(std::make_unique<State>(
          State{.camera = camera,
                .clock = FrameClock(config.trust.max_gap_s),
                .method = make_method(camera, body_from_camera, config, initial, estimator),
                .fixtures = {}})) {}
Navigator::~Navigator() = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

// A frame's journey is that of its method: KeyframeNavigator::step, PaperNavigator::step,
// ReferenceNavigator::step, BestNavigator::step or FusedNavigator::step.
NavigationEstimate Navigator::step(const Frame& frame, const SensorReadings& readings) {
  check_image(frame, state_->camera);
  const FrameInterval interval = state_->clock.pass(frame, state_->image_speed_px_s);
  const SensorReadings numbers = drop_non_finite(readings);
  const Frame masked = state_->fixtures.masked(frame);
  NavigationEstimate estimate = std::visit(
      [&](auto& method) { return method.step(masked, interval, numbers); }, state_->method);
  if (masked.mask) estimate.hidden_ratio = masked.mask->hidden_ratio();
  state_->image_speed_px_s = estimate.image_speed_px_s;
  state_->fixtures.learn(frame.grey, estimate.image_shift_px);
  return estimate;
}

std::vector<WindowFlow> Navigator::windows() const {
  return std::visit([](const auto& method) -> std::vector<WindowFlow> { return method.windows(); },
                    state_->method);
}

}  // namespace stillkite
