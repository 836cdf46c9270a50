#pragma once

#include <cstdint>
#include <filesystem>

#include "geometry/time.hpp"
#include "io/results/output_file.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Frames by what the controller answered; together they are all.
struct CommandCounts {
  std::int64_t issued = 0;
  std::int64_t held = 0;
};

/// Writes commands.csv as the frames come, and counts.
class CommandRecorder {
 public:
  /// Throws InputError if the folder cannot be written.
  explicit CommandRecorder(const std::filesystem::path& folder);

  /// Throws std::runtime_error if the disk is full; what was written before can still be committed.
  void add(Timestamp stamp, const HoldDecision& decision);

  void finish() { table_.finish(); }
  /// The file gets its name.
  void commit() { table_.commit(); }

  [[nodiscard]] const CommandCounts& counts() const { return counts_; }

 private:
  OutputFile table_;
  CommandCounts counts_;
};

}  // namespace stillkite
