#pragma once

#include <filesystem>
#include <vector>

#include "io/results/output_file.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Writes a run's estimates.csv and trajectory.tum as the frames come, and keeps the estimates for
/// what is made of them at the end.
class RunRecorder {
 public:
  /// Throws InputError if the folder cannot be written.
  explicit RunRecorder(const std::filesystem::path& folder);

  /// Throws std::runtime_error if the disk is full; what was written before can still be committed.
  void add(const NavigationEstimate& estimate);

  /// Both files are on the disk, and only their names are missing.
  void finish();
  /// Both files get their names.
  void commit();

  [[nodiscard]] const std::vector<NavigationEstimate>& estimates() const { return estimates_; }

 private:
  OutputFile table_;
  OutputFile trajectory_;
  std::vector<NavigationEstimate> estimates_;
};

}  // namespace stillkite
