#include "io/results/command_recorder.hpp"

#include "io/results/commands_csv.hpp"

namespace stillkite {
CommandRecorder::CommandRecorder(const std::filesystem::path& folder)
    : table_(folder / "commands.csv") {
  table_.write(commands_csv_header());
}

void CommandRecorder::add(Timestamp stamp, const HoldDecision& decision) {
  table_.write(commands_csv_row(stamp, decision));
  ++(decision.action == HoldAction::command ? counts_.issued : counts_.held);
}

}  // namespace stillkite
