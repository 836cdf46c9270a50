#pragma once

#include <filesystem>

#include "io/results/output_file.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Writes estimates.csv and trajectory.tum frame by frame.
class RunRecorder {
 public:
  /// Throws InputError if the folder is not writable.
  explicit RunRecorder(const std::filesystem::path& folder);

  /// Throws std::runtime_error if the disk is full; earlier frames can still be committed.
  void add(const NavigationEstimate& estimate);

  /// Flushes both files to disk; commit() then only renames.
  void finish();
  /// Renames both files.
  void commit();

 private:
  OutputFile table_;
  OutputFile trajectory_;
};

}  // namespace stillkite
