#include "app/flight_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "flow/frame.hpp"
#include "io/config/config_values.hpp"
#include "io/dataset/flight_sensors.hpp"
#include "io/dataset/initial_state.hpp"
#include "navigation/effective_config.hpp"

namespace stillkite {
namespace {

template <typename Value>
void append(TimeSeries<Value>& series, Timestamp stamp, const Value& value) {
  series.stamps.push_back(stamp);
  series.values.push_back(value);
}

template <typename Value>
void discard(TimeSeries<Value>& series, Timestamp before) {
  const auto end = std::ranges::lower_bound(series.stamps, before) - series.stamps.begin();
  series.stamps.erase(series.stamps.begin(), series.stamps.begin() + end);
  series.values.erase(series.values.begin(), series.values.begin() + end);
}

// The last reading counts as one at `stamp` if it is recent.
template <typename Value>
void hold_until(TimeSeries<Value>& series, Timestamp stamp) {
  constexpr double kMaxAge_s = 0.25;
  if (series.stamps.empty() || series.stamps.back() >= stamp ||
      seconds_between(series.stamps.back(), stamp) > kMaxAge_s) {
    return;
  }
  append(series, stamp, Value(series.values.back()));
}

// Readings of the initial state.
SensorLog held_until(SensorLog sensors, Timestamp stamp) {
  hold_until(sensors.attitude, stamp);
  hold_until(sensors.height_m, stamp);
  return sensors;
}

// False if a reading at or after `stamp` is expected.
bool reaches(const std::vector<Timestamp>& stamps, Timestamp stamp) {
  constexpr double kMaxInterval_s = 0.05, kSilent_s = 0.5;
  const std::optional<double> interval_s = median_interval_s(stamps);
  return !interval_s || *interval_s > kMaxInterval_s || stamps.back() >= stamp ||
         seconds_between(stamps.back(), stamp) > kSilent_s;
}

HeightSource height_source_of(HeightMessage message) {
  if (is_range(message)) return HeightSource::range;
  return is_relative_height(message) ? HeightSource::barometer : HeightSource::none;
}

}  // namespace

FlightEstimator::FlightEstimator(FlyConfig config)
    : config_(std::move(config)),
      telemetry_(config_.live.telemetry, static_cast<std::uint8_t>(config_.live.system_id)),
      sensor_lines_(config_.live.telemetry),
      gate_(config_.live.tether, config_.hold.max_tether_age_s),
      body_from_autopilot_(config_.imu.rotation_wxyz
                               ? unit_quaternion(*config_.imu.rotation_wxyz, "imu.rotation_wxyz")
                               : Eigen::Quaterniond::Identity()) {
  sensors_.height_source = is_relative_height(config_.live.telemetry.height)
                               ? ScaleSource::barometer
                               : ScaleSource::range;
  sensors_.imu_noise = config_.imu.noise;
}

void FlightEstimator::receive(const mavlink::Packet& packet, Timestamp arrival) {
  if (const auto sample = telemetry_.read(packet, arrival)) add(*sample);
  discard_old(arrival);
}

void FlightEstimator::receive(const SensorLine& line, Timestamp arrival) {
  for (const SensorSample& sample : sensor_lines_.read(line, arrival)) add(sample);
  discard_old(arrival);
}

void FlightEstimator::receive(const StationMessage& message, Timestamp arrival) {
  gate_.receive(message, arrival);
  const auto* attitude = std::get_if<DroneAttitude>(&message);
  const Timestamp stamp{arrival.ns - from_seconds(config_.live.tether.reading_latency_s).ns};
  const std::vector<Timestamp>& stamps = sensors_.attitude.stamps;
  if (attitude != nullptr && (stamps.empty() || stamps.back() < stamp)) {
    append(sensors_.attitude, stamp, attitude->world_from_body);
  }
  discard_old(arrival);
}

std::optional<std::string> FlightEstimator::receive(const OperatorCommand& command) {
  if (command.action == OperatorAction::hold_here) {
    if (config_.hold.mode == HoldMode::paper) return "hold.mode paper holds the reference image";
    hold_here_ = true;
  }
  return gate_.apply(command, config_.hold.recommended.max_displacement_m);
}

void FlightEstimator::discard_old(Timestamp arrival) {
  if (!oldest_kept_) oldest_kept_ = arrival;
  // without video no frame discards readings
  constexpr double kKept_s = 10;
  if (seconds_between(*oldest_kept_, arrival) < 2 * kKept_s) return;
  oldest_kept_ = Timestamp{arrival.ns - from_seconds(kKept_s).ns};
  discard_before(*oldest_kept_);
}

void FlightEstimator::add(const SensorSample& sample) {
  if (const auto* imu = std::get_if<ImuSample>(&sample)) {
    Vector6d value;
    value << body_from_autopilot_ * imu->angular_rate_in_body_rad_s,
        body_from_autopilot_ * imu->specific_force_in_body_m_s2;
    append(sensors_.imu, imu->stamp, value);
    append(sensors_.angular_rate_in_body_rad_s, imu->stamp, Eigen::Vector3d(value.head<3>()));
  } else if (const auto* attitude = std::get_if<AttitudeSample>(&sample)) {
    append(sensors_.attitude, attitude->stamp,
           Eigen::Quaterniond(attitude->world_from_body * body_from_autopilot_.conjugate()));
  } else if (const auto* height = std::get_if<HeightSample>(&sample)) {
    append(sensors_.height_m, height->stamp, height->height_m + height_offset_m_);
  }
}

bool FlightEstimator::uses_attitude() const {
  return config_.live.telemetry.attitude != AttitudeMessage::none || has_tether();
}

bool FlightEstimator::is_ready(Timestamp stamp) const {
  if (pilot_) return true;
  const SensorReadings readings = readings_between(held_until(sensors_, stamp), stamp, stamp);
  const TelemetryConfig& telemetry = config_.live.telemetry;
  const bool needs_height = is_relative_height(telemetry.height) ||
                            (is_range(telemetry.height) && !config_.initial.height_m);
  return (!uses_attitude() || readings.attitude) && (!needs_height || readings.height_m);
}

bool FlightEstimator::has_telemetry_until(Timestamp stamp) const {
  return reaches(sensors_.imu.stamps, stamp) && reaches(sensors_.attitude.stamps, stamp);
}

void FlightEstimator::initialize(const Frame& first) {
  RunConfig run = run_config_of(config_);
  inputs_ = read_flight_inputs(run, first);
  run.height.source = height_source_of(config_.live.telemetry.height);
  const SensorLog sensors = held_until(sensors_, first.stamp);
  inputs_->initial = initial_state(run, inputs_->truth, sensors, first.stamp);
  if (run.height.source == HeightSource::barometer) {
    const SensorReadings readings = readings_between(sensors, first.stamp, first.stamp);
    height_offset_m_ =
        inputs_->initial.world_from_body.translation.z() - readings.height_m.value_or(0);
    for (double& height_m : sensors_.height_m.values) height_m += height_offset_m_;
  }
  config_.navigator =
      effective_config(config_.navigator, config_.estimator.policy, inputs_->initial.scale);
  NavigatorConfig navigator = config_.navigator;
  navigator.fusion = with_imu_noise(navigator.fusion, sensors_.imu_noise);
  pilot_.emplace(inputs_->camera, inputs_->body_from_camera, navigator, config_.estimator,
                 config_.hold, inputs_->initial);
}

// Attitude at a stamp; after the last reading that one, for as long as the tether's readings.
std::optional<Eigen::Quaterniond> FlightEstimator::attitude_at(Timestamp stamp) const {
  const TimeSeries<Eigen::Quaterniond>& log = sensors_.attitude;
  const auto after = std::ranges::upper_bound(log.stamps, stamp) - log.stamps.begin();
  if (after == 0) return std::nullopt;
  const auto i = static_cast<std::size_t>(after) - 1;
  const double age_s = seconds_between(log.stamps[i], stamp);
  if (age_s > config_.hold.max_tether_age_s) return std::nullopt;
  if (i + 1 == log.stamps.size()) return log.values[i];
  const double interval_s = seconds_between(log.stamps[i], log.stamps[i + 1]);
  return log.values[i].slerp(age_s / interval_s, log.values[i + 1]);
}

PilotStep FlightEstimator::step(const Frame& frame, Timestamp decision) {
  if (!pilot_) initialize(frame);
  sensors_.imu.max_gap_s = max_gap_s(sensors_.imu.stamps);
  sensors_.angular_rate_in_body_rad_s.max_gap_s = sensors_.imu.max_gap_s;
  const Timestamp before = last_frame_.value_or(frame.stamp);
  Frame masked = frame;
  masked.mask = inputs_->mask;
  TetheredReadings readings{
      .now = {decision.ns + from_seconds(config_.live.tether.command_delay_s).ns},
      .tether = gate_.tether(),
      .station_from_body = has_tether() ? attitude_at(frame.stamp) : std::nullopt,
      .sensors = readings_between(sensors_, before, frame.stamp),
      .withheld = gate_.withheld(decision),
      .hold_here = std::exchange(hold_here_, false)};
  // without its attitude the station's axes are unknown
  if (!readings.station_from_body && readings.withheld == HoldReason::none) {
    readings.withheld = HoldReason::station_silent;
  }
  PilotStep step = pilot_->step(masked, readings);
  const MotionEstimate& motion = step.motion;
  const bool is_metric = motion.displacement_kind == DisplacementKind::metric;
  gate_.set_estimate(
      decision, is_measured(step.estimate.verdict),
      is_metric ? std::optional(motion.displacement_in_reference.norm()) : std::nullopt);
  last_frame_ = frame.stamp;
  // the next interval begins at this stamp and needs the readings around it
  constexpr double kKept_s = 2;
  discard_before({frame.stamp.ns - from_seconds(kKept_s).ns});
  step.estimate = gravity_aligned(std::move(step.estimate));
  return step;
}

std::vector<WeightedFlow> FlightEstimator::flow_vectors() const {
  return pilot_ ? pilot_->flow_vectors() : std::vector<WeightedFlow>();
}

void FlightEstimator::discard_before(Timestamp oldest) {
  discard(sensors_.imu, oldest);
  discard(sensors_.angular_rate_in_body_rad_s, oldest);
  discard(sensors_.attitude, oldest);
  discard(sensors_.height_m, oldest);
}

}  // namespace stillkite
