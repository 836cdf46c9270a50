#include "app/tether_control.hpp"

#include <fmt/format.h>

#include <utility>

#include "io/results/commands_csv.hpp"
#include "live/clock/local_clock.hpp"

namespace stillkite {
namespace {

// Reasons of operator, ground station and image, which last; others change from image to image.
bool is_reported(HoldReason reason) {
  switch (reason) {
    case HoldReason::not_engaged:
    case HoldReason::stopped:
    case HoldReason::station_mode:
    case HoldReason::station_fault:
    case HoldReason::station_silent:
    case HoldReason::not_measured:
      return true;
    default:
      return false;
  }
}

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

// Columns of a row without command after its reason.
std::string row_end_of_a_hold() {
  const HoldDecision hold{.command = {},
                          .action = HoldAction::hold,
                          .reason = HoldReason::estimator_silent,
                          .position_error_in_station_m = Eigen::Vector3d::Zero()};
  const std::string row = commands_csv_row({0}, hold);
  const std::string reason = fmt::format(",{},", name_of(hold.reason));
  const std::size_t begin = row.find(reason) + reason.size();
  return row.substr(begin, row.size() - 1 - begin);
}

}  // namespace

TetherControl::TetherControl(const LiveConfig& live, Report report)
    : report_(std::move(report)), link_(live.tether) {
  if (live.operator_source) input_.emplace(*live.operator_source);
}

void TetherControl::log_to(const std::filesystem::path& folder, FlightRecord& record) {
  record.add_command(commands_csv_header());
  link_.log_to(std::filesystem::absolute(folder / kCommandsFile).string(), row_end_of_a_hold());
}

std::int64_t TetherControl::receive(FlightEstimator& estimator, FlightRecord& record) {
  recorded_ = 0;
  receive_station(estimator, record);
  receive_operators(estimator, record);
  const CommandGate& gate = estimator.gate();
  if ((last_.is_engaged && !gate.is_engaged()) || (gate.is_stopped() && !last_.is_stopped)) {
    last_ = {.is_stopped = gate.is_stopped()};
    link_.send(last_);
  }
  if (!link_.is_supervised() && !std::exchange(has_reported_end_, true)) {
    report_("tether: the supervising process has ended; nothing is commanded any more");
  }
  return recorded_;
}

void TetherControl::receive_station(FlightEstimator& estimator, FlightRecord& record) {
  for (const ReceivedLine& received : link_.take()) {
    const auto message = parse_station_line(received.line);
    ++(message ? lines_ : ignored_lines_);
    if (!message) continue;
    record.add_message({.arrival = received.arrival,
                        .bytes = bytes_of(received.line),
                        .source = MessageSource::station});
    ++recorded_;
    estimator.receive(*message, received.arrival);
  }
}

void TetherControl::receive_operators(FlightEstimator& estimator, FlightRecord& record) {
  if (input_ && input_->read_into(operators_) > 0) {
    report_(
        "operator: a line is no command; expected {\"command\": \"engage\"}, or release, "
        "hold_here, mark, stop");
  }
  // an operator who cannot release any more
  if (input_ && input_->has_ended() && !std::exchange(has_reported_input_, true)) {
    report_("operator: end of standard input");
    operators_.push({.action = OperatorAction::release, .note = {}, .arrival = local_now()});
  }
  for (const OperatorCommand& command : operators_.take()) {
    record.add_message({.arrival = command.arrival,
                        .bytes = bytes_of(operator_line(command)),
                        .source = MessageSource::operator_command});
    ++recorded_;
    const auto refusal = estimator.receive(command);
    const std::string text =
        command.note.empty() ? std::string(name_of(command.action)) : operator_line(command);
    report_(fmt::format("operator: {}{}", text, refusal ? " refused: " + *refusal : ""));
    if (command.action == OperatorAction::hold_here) awaits_setpoint_ = !refusal;
  }
}

void TetherControl::send(const PilotStep& step, const FlightEstimator& estimator,
                         FlightRecord& record) {
  const HoldDecision& decision = step.decision;
  const CommandGate& gate = estimator.gate();
  last_ = {.is_engaged = gate.is_engaged(),
           .is_stopped = gate.is_stopped(),
           .is_measured = is_measured(step.estimate.verdict),
           .command = decision.command};
  link_.send(last_);
  record.add_command(commands_csv_row(step.estimate.stamp, decision));
  ++(decision.action == HoldAction::command ? commands_ : holds_);
  if (std::exchange(awaits_setpoint_, false)) {
    report_(step.is_setpoint_moved ? "tether: holds the pose of this image"
                                   : "tether: hold_here refused: no metric displacement");
  }
  const HoldReason withheld = is_reported(decision.reason) ? decision.reason : HoldReason::none;
  if (withheld == std::exchange(last_withheld_, withheld)) return;
  report_(withheld == HoldReason::none
              ? std::string("tether: engaged")
              : fmt::format("tether: commands are withheld: {}", name_of(withheld)));
}

std::string TetherControl::counts() const {
  return fmt::format(
      "tether: {} lines read, {} of other messages or damaged; {} commands, {} holds", lines_,
      ignored_lines_, commands_, holds_);
}

}  // namespace stillkite
