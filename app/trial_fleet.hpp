#pragma once

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

#include "app/progress_bar.hpp"
#include "io/report/hover_report.hpp"
#include "simulation/hover/hover_trial.hpp"

namespace stillkite {

/// Flies trials in parallel, one per thread. Records are in the order of the trials.
class TrialFleet {
 public:
  /// `config` and `world` must outlive the object.
  TrialFleet(const HoverConfig& config, const HoverWorld& world, std::vector<Trial> trials,
             const std::string& label);

  /// Flies until all are done, Ctrl-C, or an exception in a trial, which is returned.
  [[nodiscard]] std::exception_ptr fly(int jobs);

  /// Completed trials.
  [[nodiscard]] const std::vector<TrialRecord>& records() const { return records_; }
  /// Thumbnails at 5 Hz of the first trial with an estimator along each axis.
  [[nodiscard]] const std::vector<std::vector<HoverImage>>& images() const { return images_; }

 private:
  void fly_pending();
  void remove_unfinished();
  [[nodiscard]] bool is_recorded(std::size_t i) const;

  const HoverConfig& config_;
  const HoverWorld& world_;
  std::vector<Trial> trials_;
  std::vector<std::size_t> order_;  // longest first, for an even load at the end
  std::vector<TrialRecord> records_;
  std::vector<std::vector<HoverImage>> images_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
  ProgressBar progress_;
};

}  // namespace stillkite
