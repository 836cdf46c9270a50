#include "app/page_state.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/flight_alarms.hpp"
#include "app/level_displacement.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

// Latest sample at least `age_s` older than the last one, else the first one.
const HistorySample& sample_before(const std::vector<HistorySample>& samples, double age_s) {
  const auto older = std::find_if(samples.rbegin(), samples.rend(), [&](const auto& sample) {
    return seconds_between(sample.time, samples.back().time) >= age_s;
  });
  return older == samples.rend() ? samples.front() : *older;
}

json displacement_json(const PageSnapshot& snapshot) {
  const MotionEstimate& motion = snapshot.step.motion;
  json out{{"kind", name_of(motion.displacement_kind)}};
  const LevelDisplacement level = level_displacement(
      motion, snapshot.step.estimate.world_from_body.rotation, snapshot.body_from_camera);
  out["yaw"] = level.yaw_rad;
  if (motion.displacement_kind == DisplacementKind::unknown) return out;
  const Eigen::Vector3d& d = level.displacement;
  out["forward"] = d.x();
  out["left"] = d.y();
  out["up"] = d.z();
  if (motion.displacement_kind == DisplacementKind::direction) return out;
  out["length"] = d.norm();
  if (motion.displacement_kind == DisplacementKind::zero) return out;
  const DisplacementEllipse ellipse = horizontal_ellipse(level.covariance);
  out["ellipse"] = {ellipse.major, ellipse.minor, ellipse.angle_rad};
  return out;
}

json estimate_json_of(const PageSnapshot& snapshot, Timestamp now) {
  const NavigationEstimate& estimate = snapshot.step.estimate;
  const bool has_lengths = estimate.scale != ScaleSource::none || is_in_heights(estimate);
  const Eigen::Vector3d& velocity = estimate.velocity_in_world_m_s;
  json out{{"age_s", seconds_between(snapshot.estimated, now)},
           {"verdict", name_of(estimate.verdict)},
           {"verdict_words", verdict_words(estimate.verdict)},
           {"is_measured", is_measured(estimate.verdict)},
           {"source", name_of(estimate.source)},
           {"unit", is_in_heights(estimate) ? "heights" : "m"},
           {"latency_ms", 1e3 * snapshot.latency_s},
           {"displacement", displacement_json(snapshot)},
           {"scale", {{"source", name_of(estimate.scale)}, {"age_s", estimate.scale_age_s}}}};
  if (has_lengths) {
    out["speed"] = velocity.norm();
    out["vertical_speed"] = velocity.z();
    out["height"] = estimate.world_from_body.translation.z();
  }
  return out;
}

json control_json(const PageState& state) {
  const FlightStatus& status = state.status;
  if (!status.has_station) return nullptr;
  json out{{"engaged", status.is_engaged}, {"stopped", status.is_stopped}};
  if (state.newest) {
    const HoldDecision& decision = state.newest->step.decision;
    out["reason"] = reason_words(decision.reason);
    out["commands"] = decision.action == HoldAction::command;
  }
  return out;
}

json replay_json(const FlightStatus& status) {
  if (!status.replay) return nullptr;
  return {{"speed", status.replay->speed},
          {"time_s", status.replay->time_s},
          {"ended", status.replay->has_ended}};
}

json samples_json(const std::vector<HistorySample>& samples, std::int64_t after, Timestamp now) {
  json out = json::array();
  for (const HistorySample& sample : samples) {
    if (sample.number <= after) continue;
    out.push_back({sample.number, seconds_between(now, sample.time), sample.speed, sample.height,
                   sample.displacement_m, sample.latency_ms, name_of(sample.verdict)});
  }
  return out;
}

}  // namespace

ImageRates image_rates(const std::vector<HistorySample>& samples) {
  constexpr double kRate_s = 2, kDropped_s = 10;
  if (samples.size() < 2) return {};
  ImageRates out;
  const HistorySample& last = samples.back();
  const HistorySample& recent = sample_before(samples, kRate_s);
  out.used_per_s = static_cast<double>(last.used_images - recent.used_images) /
                   seconds_between(recent.time, last.time);
  const HistorySample& older = sample_before(samples, kDropped_s);
  const std::int64_t decoded = last.decoded_images - older.decoded_images;
  if (decoded > 0) {
    out.dropped_ratio = static_cast<double>(last.replaced_images - older.replaced_images) /
                        static_cast<double>(decoded);
  }
  return out;
}

json page_json(const PageState& state, Timestamp now, std::int64_t after) {
  const ImageRates rates = image_rates(state.samples);
  json messages = json::array();
  for (const OperatorMessage& message : state.messages) {
    messages.push_back({seconds_between(message.time, now), message.text});
  }
  return {{"flight", state.flight},
          {"estimate", state.newest ? estimate_json_of(*state.newest, now) : json(nullptr)},
          {"control", control_json(state)},
          {"replay", replay_json(state.status)},
          {"alarms", flight_alarms(state, now)},
          {"messages", messages},
          {"images",
           {{"used_per_s", rates.used_per_s ? json(*rates.used_per_s) : json(nullptr)},
            {"dropped_ratio", rates.dropped_ratio ? json(*rates.dropped_ratio) : json(nullptr)},
            {"dropped", state.status.images.replaced}}},
          {"samples", samples_json(state.samples, after, now)}};
}

}  // namespace stillkite
