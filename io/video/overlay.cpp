#include "io/video/overlay.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/video/overlay_canvas.hpp"
#include "io/video/overlay_geometry.hpp"

namespace stillkite {
namespace {

const cv::Scalar kWhite(245, 245, 245);
const cv::Scalar kSoft(190, 190, 190);
const cv::Scalar kInlier(190, 200, 60);
const cv::Scalar kOutlier(60, 70, 240);
const cv::Scalar kVelocity(60, 200, 255);
const cv::Scalar kHorizon(255, 190, 90);
const cv::Scalar kGood(95, 150, 35);
const cv::Scalar kWarning(0, 130, 230);
const cv::Scalar kBad(40, 40, 200);

/// Flow vectors with a lower robust weight are drawn as outliers.
constexpr float kOutlierWeight = 0.5F;

const cv::Scalar& colour_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
    case Verdict::still:
      return kGood;
    case Verdict::first_frame:
    case Verdict::frozen:
    case Verdict::time_gap:
      return kWarning;
    default:
      return kBad;
  }
}

/// Camera pixel to pixel of the enlarged image.
cv::Point2d enlarged(const Eigen::Vector2d& pixel, int zoom) {
  return {(pixel.x() + 0.5) * zoom - 0.5, (pixel.y() + 0.5) * zoom - 0.5};
}

/// Smallest 1, 2 or 5 times a power of ten that is >= x > 0.
double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= x) return factor * power;
  }
  return 10 * power;
}

/// 0 without flow vectors.
double mean_flow_px(std::span<const WeightedFlow> flow_vectors) {
  double sum = 0;
  for (const WeightedFlow& vector : flow_vectors) sum += vector.flow_px.norm();
  return flow_vectors.empty() ? 0 : sum / static_cast<double>(flow_vectors.size());
}

/// Power of two, 1/4 to 32, that scales the mean flow to about `target_px`.
double arrow_gain(double mean_flow_px, double target_px) {
  if (!(mean_flow_px > 0)) return 1;
  return std::exp2(std::clamp(std::round(std::log2(target_px / mean_flow_px)), -2.0, 5.0));
}

/// Draws all outliers and one inlier per cell of a coarse grid.
void draw_flow(OverlayCanvas& canvas, std::span<const WeightedFlow> flow_vectors, int zoom,
               double gain) {
  constexpr double kCell = 34;  // units
  const double cell_px = kCell * canvas.unit();
  const auto columns = static_cast<std::size_t>(canvas.size().width / cell_px) + 1;
  const auto rows = static_cast<std::size_t>(canvas.size().height / cell_px) + 1;
  std::vector<bool> occupied(columns * rows, false);
  for (const WeightedFlow& vector : flow_vectors) {
    const cv::Point2d at = enlarged(vector.centre_px.cast<double>(), zoom);
    if (!(at.x >= 0 && at.y >= 0 && at.x < canvas.size().width && at.y < canvas.size().height)) {
      continue;
    }
    const double shown_px = gain * zoom * vector.flow_px.norm();
    if (!(shown_px < canvas.size().width)) continue;
    if (vector.weight < kOutlierWeight) {
      canvas.dot(at, 2.2, kOutlier);
      continue;
    }
    const std::size_t cell = static_cast<std::size_t>(at.y / cell_px) * columns +
                             static_cast<std::size_t>(at.x / cell_px);
    if (occupied[cell]) continue;
    occupied[cell] = true;
    const cv::Point2d flow(vector.flow_px.x(), vector.flow_px.y());
    canvas.line(at, at + gain * zoom * flow, 1.4, kInlier);
    canvas.dot(at, 2.0, kInlier);
  }
}

void draw_horizon(OverlayCanvas& canvas, const Camera& camera,
                  const Eigen::Quaterniond& world_from_camera, int zoom) {
  const auto horizon = horizon_pixels(camera, world_from_camera);
  for (std::size_t i = 1; i < horizon.size(); ++i) {
    canvas.line(enlarged(horizon[i - 1], zoom), enlarged(horizon[i], zoom), 2.2, kHorizon);
  }
  const Eigen::Vector3d down = -(world_from_camera.conjugate() * Eigen::Vector3d::UnitZ());
  if (const auto nadir = direction_pixel(camera, down)) {
    const cv::Point2d at = enlarged(*nadir, zoom);
    const double length_px = 18 * canvas.unit();
    canvas.ring(at, 9, 2, kHorizon);
    for (const cv::Point2d& side : {cv::Point2d{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      canvas.line(at + 0.5 * length_px * side, at + length_px * side, 2, kHorizon);
    }
  }
}

/// Image-plane component of the velocity as an arrow, and the focus of expansion as a ring.
void draw_velocity(OverlayCanvas& canvas, const Camera& camera, int zoom,
                   const Eigen::Vector3d& velocity_in_camera_m_s, double full_scale_m_s) {
  const cv::Point2d centre(0.5 * canvas.size().width, 0.5 * canvas.size().height);
  const double length_px = 0.3 * canvas.size().height / full_scale_m_s;
  const cv::Point2d in_image(velocity_in_camera_m_s.x(), velocity_in_camera_m_s.y());
  canvas.arrow(centre, centre + length_px * in_image, 5, kVelocity);
  canvas.dot(centre, 5, kVelocity);
  if (const auto aim = direction_pixel(camera, velocity_in_camera_m_s)) {
    const cv::Point2d at = enlarged(*aim, zoom);
    const double u = canvas.unit();
    canvas.ring(at, 10, 2.5, kVelocity);
    for (const double side : {-1.0, 1.0}) {
      canvas.line(at + cv::Point2d(side * 10 * u, 0), at + cv::Point2d(side * 24 * u, 0), 2.5,
                  kVelocity);
    }
  }
}

// Without metric scale only the flow gives lengths, in initial heights.
void write_lengths(OverlayCanvas& canvas, const NavigationEstimate& estimate) {
  const double u = canvas.unit();
  const bool metric = estimate.scale != ScaleSource::none;
  if (!metric && estimate.source != EstimateSource::flow) {
    canvas.text("speed unknown", {26 * u, 92 * u}, 22, kWhite, true);
    canvas.text("no scale: position held", {26 * u, 120 * u}, 11.5, kSoft);
    return;
  }
  const char* length = metric ? "m" : "heights";
  const Eigen::Vector3d& velocity = estimate.velocity_in_world_m_s;
  canvas.text(fmt::format("{:.2f} {}/s", velocity.norm(), length), {26 * u, 92 * u}, 22, kWhite,
              true);
  canvas.text(fmt::format("V {:+.2f} {:+.2f} {:+.2f}", velocity.x(), velocity.y(), velocity.z()),
              {26 * u, 120 * u}, 11.5, kSoft);
  canvas.text(fmt::format("height {:.2f} {}", estimate.world_from_body.translation.z(), length),
              {26 * u, 142 * u}, 11.5, kSoft);
}

void write_figures(OverlayCanvas& canvas, const NavigationEstimate& estimate) {
  const double u = canvas.unit();
  const EulerAngles angles = to_euler(estimate.world_from_body.rotation);

  canvas.panel({14 * u, 14 * u, 356 * u, 164 * u});
  std::string verdict(name_of(estimate.verdict));
  std::replace(verdict.begin(), verdict.end(), '_', ' ');
  canvas.pill(verdict, {26 * u, 26 * u}, 28, colour_of(estimate.verdict));
  write_lengths(canvas, estimate);
  canvas.text(fmt::format("roll {:+.1f}  pitch {:+.1f}  yaw {:+.1f}", angles.roll_rad / kDegree,
                          angles.pitch_rad / kDegree, angles.yaw_rad / kDegree),
              {26 * u, 164 * u}, 11.5, kSoft);
}

void write_footer(OverlayCanvas& canvas, const NavigationEstimate& estimate, double flow_px,
                  double gain) {
  const double u = canvas.unit();
  const double top = canvas.size().height - 34 * u;
  const FlowQuality& quality = estimate.quality;
  canvas.panel({0, top, static_cast<double>(canvas.size().width), 34 * u});
  canvas.text(fmt::format("{:9.3f} s  #{}   {} vectors, {:.0f} % inliers, residual {:.3f} px, flow "
                          "{:.2f} px (drawn x{:g})",
                          to_seconds(estimate.stamp), estimate.frame_index, quality.flow_vectors,
                          100 * quality.inlier_ratio, quality.residual_px, flow_px, gain),
              {16 * u, top + 22 * u}, 11, kWhite);
}

}  // namespace

Overlay::Overlay(const Camera& camera, const RigidTransform& body_from_camera, OverlayText text)
    : camera_(camera), body_from_camera_(body_from_camera), text_(text) {
  // legible text needs 900 px, lines alone 400
  const int min_width_px = text == OverlayText::figures ? 900 : 400;
  zoom_ = std::max(1, (min_width_px + camera.width_px - 1) / camera.width_px);
  size_ = {camera.width_px * zoom_ / 2 * 2, camera.height_px * zoom_ / 2 * 2};
}

void Overlay::paint_background(const cv::Mat& grey) {
  cv::Mat large;
  cv::resize(grey, large, {}, zoom_, zoom_, cv::INTER_LINEAR);
  // darkened, for contrast with the drawing
  large.convertTo(large, -1, 0.82);
  cv::cvtColor(large(cv::Rect({0, 0}, size_)), image_, cv::COLOR_GRAY2BGR);
}

const cv::Mat& Overlay::draw(const cv::Mat& grey, const NavigationEstimate& estimate,
                             std::span<const WeightedFlow> flow_vectors) {
  const Eigen::Quaterniond world_from_camera =
      estimate.world_from_body.rotation * body_from_camera_.rotation;
  const Eigen::Vector3d& velocity = estimate.twist_in_camera.velocity_m_s;
  paint_background(grey);
  OverlayCanvas canvas(image_);

  // 1. Measurements.
  const double flow_px = mean_flow_px(flow_vectors);
  const double gain = arrow_gain(flow_px * zoom_, 20 * canvas.unit());
  draw_flow(canvas, flow_vectors, zoom_, gain);
  draw_horizon(canvas, camera_, world_from_camera, zoom_);

  // 2. Estimates.
  if (velocity.allFinite()) max_speed_m_s_ = std::max(max_speed_m_s_, velocity.norm());
  if (max_speed_m_s_ > 0) {
    draw_velocity(canvas, camera_, zoom_, velocity, round_up(max_speed_m_s_));
  }
  if (text_ == OverlayText::none) return image_;
  write_figures(canvas, estimate);
  write_footer(canvas, estimate, flow_px, gain);
  return image_;
}

}  // namespace stillkite
