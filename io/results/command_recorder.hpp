#pragma once

#include <cstdint>
#include <filesystem>

#include "geometry/time.hpp"
#include "io/results/output_file.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Frames with a command and frames on hold; their sum is the number of frames.
struct CommandCounts {
  std::int64_t issued = 0;
  std::int64_t held = 0;
};

/// Writes commands.csv row by row and counts commands.
class CommandRecorder {
 public:
  /// Throws InputError if the folder is not writable.
  explicit CommandRecorder(const std::filesystem::path& folder);

  /// Throws std::runtime_error if the disk is full; earlier rows can still be committed.
  void add(Timestamp stamp, const HoldDecision& decision);

  void finish() { table_.finish(); }
  /// Renames the file to commands.csv.
  void commit() { table_.commit(); }

  [[nodiscard]] const CommandCounts& counts() const { return counts_; }

 private:
  OutputFile table_;
  CommandCounts counts_;
};

}  // namespace stillkite
