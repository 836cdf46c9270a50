#include "live/tether/command_gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <variant>

namespace stillkite {
namespace {

template <typename Received>
bool is_older(const std::optional<Received>& received, Timestamp now, double max_age_s) {
  return !received || seconds_between(received->arrival, now) > max_age_s;
}

bool contains(const std::vector<double>& modes, int mode) {
  return std::ranges::find(modes, static_cast<double>(mode)) != modes.end();
}

// Ends an engagement, other than a silence that passes.
bool is_final(HoldReason reason) {
  return reason == HoldReason::station_mode || reason == HoldReason::station_fault;
}

}  // namespace

void CommandGate::receive(const StationMessage& message, Timestamp arrival) {
  if (const auto* station = std::get_if<StationStatus>(&message)) station_ = {*station, arrival};
  if (const auto* position = std::get_if<DronePosition>(&message)) {
    position_ = {*position, arrival};
  }
  if (const auto* drone = std::get_if<DroneStatus>(&message)) drone_ = {*drone, arrival};
  if (std::holds_alternative<DroneAttitude>(message)) attitude_arrival_ = arrival;
  // at once: a change of mode between two images is not overlooked
  if (is_final(station_reason(arrival))) is_engaged_ = false;
}

void CommandGate::set_estimate(Timestamp now, bool is_measured,
                               std::optional<double> displacement_m) {
  if (is_measured) last_measured_ = now;
  displacement_m_ = displacement_m;
}

// Modes and faults first: they end an engagement even if the rest is silent.
HoldReason CommandGate::station_reason(Timestamp now) const {
  const auto& flight_modes = config_.flight_modes;
  if (station_ && !contains(config_.station_modes, station_->message.mode)) {
    return HoldReason::station_mode;
  }
  if (drone_ && !contains(flight_modes, drone_->message.mode)) return HoldReason::station_mode;
  const auto ignored = static_cast<std::uint32_t>(config_.ignored_flags);
  if (drone_ && (drone_->message.fault_flags & ~ignored) != 0) return HoldReason::station_fault;
  if (is_older(drone_, now, config_.max_status_age_s) ||
      is_older(station_, now, max_reading_age_s_) || is_older(position_, now, max_reading_age_s_) ||
      !attitude_arrival_ || seconds_between(*attitude_arrival_, now) > max_reading_age_s_) {
    return HoldReason::station_silent;
  }
  return HoldReason::none;
}

bool CommandGate::is_unmeasured(Timestamp now) const {
  return !last_measured_ || seconds_between(*last_measured_, now) > config_.max_unmeasured_s;
}

std::optional<std::string> CommandGate::refusal(Timestamp now, double max_displacement_m) const {
  if (is_stopped_) return "stopped for this flight";
  switch (const HoldReason reason = station_reason(now)) {
    case HoldReason::none:
      break;
    case HoldReason::station_mode:
      return "the ground station is in another mode; see live.tether.station_modes, flight_modes";
    case HoldReason::station_fault:
      return fmt::format("the ground station reports faults 0x{:x}", drone_->message.fault_flags);
    default:
      return fmt::format("{}: no current !GSStatus, !Pos, !Attitude or !FlightStatus",
                         name_of(reason));
  }
  if (is_unmeasured(now)) return "no measured image";
  if (displacement_m_ && *displacement_m_ > max_displacement_m) {
    return fmt::format("displacement of {:.2f} m; hold_here selects the present pose",
                       *displacement_m_);
  }
  return std::nullopt;
}

std::optional<std::string> CommandGate::apply(const OperatorCommand& command,
                                              double max_displacement_m) {
  switch (command.action) {
    case OperatorAction::stop:
      is_stopped_ = true;
      is_engaged_ = false;
      break;
    case OperatorAction::release:
      is_engaged_ = false;
      break;
    case OperatorAction::engage:
      if (auto reason = refusal(command.arrival, max_displacement_m)) return reason;
      is_engaged_ = true;
      break;
    case OperatorAction::hold_here:
    case OperatorAction::mark:
      break;
  }
  return std::nullopt;
}

HoldReason CommandGate::withheld(Timestamp now) {
  if (is_stopped_) return HoldReason::stopped;
  const HoldReason reason = station_reason(now);
  if (is_final(reason)) is_engaged_ = false;
  if (reason != HoldReason::none && (is_engaged_ || is_final(reason))) return reason;
  if (!is_engaged_) return HoldReason::not_engaged;
  return is_unmeasured(now) ? HoldReason::not_measured : HoldReason::none;
}

std::optional<TetherReading> CommandGate::tether() const {
  if (!station_ || !position_) return std::nullopt;
  const DronePosition& position = position_->message;
  const double length_m =
      config_.length_at_zero_m + config_.m_per_count * station_->message.relative_length_counts;
  const Timestamp older = std::min(station_->arrival, position_->arrival);
  return TetherReading{
      .stamp = {older.ns - from_seconds(config_.reading_latency_s).ns},
      .tether = {.length_m = length_m,
                 .elevation_rad = std::numbers::pi / 2 - position.elevation_from_zenith_rad,
                 .azimuth_rad = position.azimuth_rad}};
}

}  // namespace stillkite
