#include "simulation/hover/hover_video.hpp"

#include <utility>

#include "simulation/hover/fault_effects.hpp"
#include "simulation/hover/hover_streams.hpp"
#include "simulation/render/develop.hpp"

namespace stillkite {
namespace {

// Constant velocity during the exposure; the stamp is its centre.
Shutter shutter_about(const DroneTruth& truth, const SimulatedCameraConfig& camera) {
  const auto at = [&](double from_now_s) {
    const Eigen::Vector3d rotation_rad(0, 0, truth.yaw_rate_rad_s * from_now_s);
    return RigidTransform{
        so3_exp(rotation_rad) * truth.world_from_camera.rotation,
        truth.world_from_camera.translation + truth.velocity_in_world_m_s * from_now_s};
  };
  return {.world_from_camera_at_opening = at(-0.5 * camera.shutter_s),
          .world_from_camera_at_closing = at(0.5 * camera.shutter_s),
          .instants = camera.shutter_s > 0 ? camera.shutter_samples : 1};
}

// Haze: contrast reduction about a uniform grey.
cv::Mat with_haze(const cv::Mat& irradiance, double contrast_ratio) {
  constexpr double kHaze_grey = 128;
  cv::Mat out;
  irradiance.convertTo(out, -1, contrast_ratio, (1 - contrast_ratio) * kHaze_grey);
  return out;
}

bool is_transmission_due(std::int64_t count, double period_s, double t_s) {
  return t_s >= static_cast<double>(count) * period_s - 1e-9;
}

}  // namespace

HoverVideo::HoverVideo(const HoverConfig& config, const HoverWorld& world, const Trial& trial)
    : config_(config),
      world_(world),
      duration_s_(trial_duration_s(config, trial)),
      is_transmitting_(trial.stabilized || config.trials.estimate_off),
      noise_seed_(hover_random(trial.seed, HoverStream::pixels).bits()) {
  if (config.plant.moving_objects) {
    moving_objects_ =
        make_moving_objects(*config.plant.moving_objects,
                            hover_random(trial.seed, HoverStream::trial_moving_objects).bits());
  }
}

bool HoverVideo::expose(const DroneTruth& truth, const Eigen::Quaterniond& attitude, Timestamp now,
                        const FaultEffect& fault) {
  const double t_s = to_seconds(now);
  if (t_s < static_cast<double>(frames_) / config_.plant.camera.frames_per_s - 1e-9) return false;
  const bool is_sent =
      is_transmitting_ && is_transmission_due(transmissions_, config_.cycle.period_s, t_s);
  if (is_sent) {
    const bool is_lost = fault.is_every_third_frame_lost && transmissions_ % 3 == 2;
    const bool is_repeated = fault.is_video_frozen && !last_.empty();
    if (!is_repeated) last_ = image(truth, now, fault);
    const double delay_s = config_.plant.camera_latency_s + config_.cycle.compute_s;
    const Timestamp stamp{now.ns + from_seconds(fault.stamp_offset_s).ns};
    if (!is_lost) {
      pending_.push_back({.due = {now.ns + from_seconds(delay_s).ns},
                          .frame = {.stamp = stamp, .index = frames_, .grey = last_.clone()},
                          .attitude = attitude,
                          .truth = truth});
    }
    ++transmissions_;
  }
  ++frames_;
  return true;
}

std::optional<SentImage> HoverVideo::receive(Timestamp now) {
  if (pending_.empty() || pending_.front().due > now) return std::nullopt;
  SentImage ready = std::move(pending_.front());
  pending_.pop_front();
  return ready;
}

// Noise-free image of the current scene.
cv::Mat HoverVideo::irradiance(const DroneTruth& truth, Timestamp now,
                               const FaultEffect& fault) const {
  const Shutter shutter = shutter_about(truth, config_.plant.camera);
  if (fault.floor_displacement_m.isZero(0) && moving_objects_.empty()) {
    return world_.renderer.render(world_.scene, shutter);
  }
  PatchScene scene = displace_floor(world_.scene, fault.floor_displacement_m);
  if (!moving_objects_.empty()) {
    scene = with_moving_objects(std::move(scene), *config_.plant.moving_objects, moving_objects_,
                                to_seconds(now));
  }
  return world_.renderer.render(scene, shutter);
}

double HoverVideo::gain(Timestamp now) const {
  Random flicker(noise_seed_, static_cast<std::uint64_t>(frames_));
  return config_.plant.camera.gain(to_seconds(now) / duration_s_, flicker.uniform(-1, 1));
}

cv::Mat HoverVideo::image(const DroneTruth& truth, Timestamp now, const FaultEffect& fault) const {
  const PlantConfig& plant = config_.plant;
  cv::Mat light = irradiance(truth, now, fault);
  if (fault.covered_ratio > 0) light = occluded(light, fault.covered_ratio, to_seconds(now));
  if (plant.contrast_ratio < 1) light = with_haze(light, plant.contrast_ratio);
  const cv::Mat grey =
      develop(light, {.gain = gain(now) * fault.light_ratio, .noise_grey = plant.camera.noise_grey},
              noise_seed_ + static_cast<std::uint64_t>(frames_));
  return world_.link ? world_.link(grey) : grey;
}

}  // namespace stillkite
