#include "navigation/navigator.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "flow/frame.hpp"
#include "flow/frame_copies.hpp"
#include "flow/image_mask.hpp"
#include "flow/standstill_detector.hpp"
#include "flow/static_overlay_detector.hpp"
#include "navigation/best_navigator.hpp"
#include "navigation/effective_config.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/fused_navigator.hpp"
#include "navigation/image_rotation.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/paper_navigator.hpp"
#include "navigation/reference_navigator.hpp"
#include "navigation/window_navigator.hpp"

namespace stillkite {
namespace {

using Method = std::variant<KeyframeNavigator, PaperNavigator, ReferenceNavigator, BestNavigator,
                            FusedNavigator, WindowNavigator>;

Method make_method(const Camera& camera, const RigidTransform& body_from_camera,
                   const NavigatorConfig& config, const InitialState& initial,
                   const EstimatorConfig& estimator) {
  const double height_m = (initial.world_from_body * body_from_camera).translation.z();
  if (!(height_m > 0)) {
    throw InputError(fmt::format(
        "navigator: initial camera height {:.4g}; it must be above the ground, z > 0", height_m));
  }
  if (!(camera.width_px > 0 && camera.height_px > 0 && camera.focal_x_px > 0 &&
        camera.focal_y_px > 0)) {
    throw InputError("navigator: image size and focal lengths of the camera must be positive");
  }
  if (estimator.policy == Policy::reference) {
    return ReferenceNavigator(camera, body_from_camera, config, initial, estimator.mode);
  }
  if (estimator.policy == Policy::best) {
    return BestNavigator(camera, body_from_camera, config, initial, estimator.mode);
  }
  if (estimator.policy == Policy::fused && config.fusion.solver == FusionSolver::window) {
    return WindowNavigator(camera, body_from_camera, config, initial);
  }
  if (estimator.policy == Policy::fused) {
    return FusedNavigator(camera, body_from_camera,
                          effective_config(config, estimator.policy, initial.scale), initial);
  }
  // policy flow
  if (estimator.mode == Mode::paper)
    return PaperNavigator(camera, body_from_camera, config, initial);
  return KeyframeNavigator(camera, body_from_camera, config, initial);
}

void check_image(const Frame& frame, const Camera& camera) {
  const cv::Mat& grey = frame.grey;
  if (frame.mask && frame.mask->valid_pixels().size() != grey.size()) {
    throw InputError(
        fmt::format("frame {}: image {}x{} pixels, mask {}x{} pixels; both must have the same size",
                    frame.index, grey.cols, grey.rows, frame.mask->valid_pixels().cols,
                    frame.mask->valid_pixels().rows));
  }
  if (grey.type() == CV_8UC1 && grey.cols == camera.width_px && grey.rows == camera.height_px) {
    return;
  }
  throw InputError(fmt::format(
      "frame {}: image {}x{} with {} bytes per pixel; the camera needs {}x{} with 1 byte",
      frame.index, grey.cols, grey.rows, grey.elemSize(), camera.width_px, camera.height_px));
}

// Not part of the papers' procedure; the filter of `fused` measures it.
bool detects_standstill(const EstimatorConfig& estimator, FusionSolver solver) {
  return estimator.mode_in_use() == Mode::recommended &&
         (estimator.policy != Policy::fused || solver == FusionSolver::window);
}

// A range finder without an echo may return infinity. `inertial_steps` checks the IMU readings.
SensorReadings drop_non_finite(SensorReadings readings) {
  const auto reset_unless = [](auto& reading, bool is_finite) {
    if (!is_finite) reading.reset();
  };
  if (readings.height_m) reset_unless(readings.height_m, std::isfinite(*readings.height_m));
  if (readings.attitude) reset_unless(readings.attitude, readings.attitude->coeffs().allFinite());
  if (readings.acceleration)
    reset_unless(readings.acceleration, readings.acceleration->allFinite());
  if (auto& rate = readings.mean_angular_rate_in_body_rad_s) reset_unless(rate, rate->allFinite());
  return readings;
}

}  // namespace

struct Navigator::State {
  Camera camera;
  RigidTransform body_from_camera;
  FrameCopies copies;
  FrameClock clock;
  Method method;
  ImageRotation rotation;
  StaticOverlayDetector static_overlays;
  std::optional<StandstillDetector> standstill;
};

Navigator::Navigator(const Camera& camera, const RigidTransform& body_from_camera,
                     const NavigatorConfig& config, const InitialState& initial,
                     const EstimatorConfig& estimator, const std::optional<ImageView>& valid_pixels)
    : state_(std::make_unique<State>(
          State{.camera = camera,
                .body_from_camera = body_from_camera,
                .copies = FrameCopies(camera, valid_pixels),
                .clock = FrameClock(config.trust.max_gap_s),
                .method = make_method(camera, body_from_camera, config, initial, estimator),
                .rotation = {},
                .static_overlays = {},
                .standstill = detects_standstill(estimator, config.fusion.solver)
                                  ? std::optional<StandstillDetector>(std::in_place)
                                  : std::nullopt})) {}
Navigator::~Navigator() = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

Estimate Navigator::step(const ImageView& image, Timestamp stamp, const SensorReadings& readings,
                         double stamp_sigma_s) {
  Frame frame = state_->copies.copy(image, stamp);
  frame.stamp_sigma_s = stamp_sigma_s;
  return public_estimate(step(frame, readings), state_->body_from_camera);
}

// The estimation steps are in the method's `step`: KeyframeNavigator, PaperNavigator,
// ReferenceNavigator, BestNavigator,
// FusedNavigator or WindowNavigator.
NavigationEstimate Navigator::step(const Frame& frame, const SensorReadings& readings) {
  // 1. Check size and type of the image.
  check_image(frame, state_->camera);
  // 2. Check the interval (first frame, time gap, frozen image); remove non-finite readings.
  FrameInterval interval = state_->clock.check(frame);
  const SensorReadings finite_readings = drop_non_finite(readings);
  // 3. Mask static overlays and airframe in view.
  const Frame masked = state_->static_overlays.masked(frame);
  // 4. Detect rest of the camera.
  if (state_->standstill && (!interval.rejection || interval.rejection == Verdict::first_frame)) {
    const std::optional<Standstill> standstill = state_->standstill->update(masked);
    const double rad_per_px = 1 / state_->camera.focal_x_px;
    if (standstill) {
      interval.standstill = StandstillSigma{rad_per_px * standstill->speed_px_s,
                                            rad_per_px * standstill->displacement_px};
    }
  }
  // 5. Estimate the motion by the policy's method; its image displacement updates the overlays.
  NavigationEstimate estimate = std::visit(
      [&](auto& method) { return method.step(masked, interval, finite_readings); }, state_->method);
  if (const auto* flow = std::get_if<KeyframeNavigator>(&state_->method)) {
    estimate.measured_rate_in_camera_rad_s =
        state_->rotation.update(flow->view(), estimate.new_keyframe, interval.dt_s);
  }
  if (masked.mask) estimate.masked_ratio = masked.mask->masked_ratio();
  state_->static_overlays.update(frame.grey, estimate.image_shift_px);
  return estimate;
}

std::vector<InertialFinding> Navigator::inertial_findings() const {
  const auto* window = std::get_if<WindowNavigator>(&state_->method);
  return window ? window->inertial_findings() : std::vector<InertialFinding>();
}

std::vector<WeightedFlow> Navigator::flow_vectors() const {
  return std::visit(
      [](const auto& method) -> std::vector<WeightedFlow> { return method.flow_vectors(); },
      state_->method);
}

}  // namespace stillkite
