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

/// Trials flown side by side, one a thread; the records are in the trials' order.
class TrialFleet {
 public:
  /// `config` and `world` must outlive it.
  TrialFleet(const HoverConfig& config, const HoverWorld& world, std::vector<Trial> trials,
             const std::string& label);

  /// Until all are flown, Ctrl-C, or a trial throws, and what it throws is returned.
  [[nodiscard]] std::exception_ptr fly(int jobs);

  /// Those that were flown to their end.
  [[nodiscard]] const std::vector<TrialRecord>& records() const { return records_; }
  /// Of what the camera saw, a few a second, of one trial an axis that an estimator looks at.
  [[nodiscard]] const std::vector<std::vector<HoverImage>>& images() const { return images_; }

 private:
  void fly_next_ones();
  void forget_unfinished();
  [[nodiscard]] bool is_filmed(std::size_t i) const;

  const HoverConfig& config_;
  const HoverWorld& world_;
  std::vector<Trial> trials_;
  std::vector<std::size_t> order_;  // the longest first: none is left alone at the end
  std::vector<TrialRecord> records_;
  std::vector<std::vector<HoverImage>> images_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
  ProgressBar progress_;
};

}  // namespace stillkite
