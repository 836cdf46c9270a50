#include "app/trial_fleet.hpp"

#include <algorithm>
#include <numeric>
#include <thread>

#include "app/hover_report_trials.hpp"
#include "app/interrupt.hpp"

namespace stillkite {
namespace {

void append_image(const Frame& frame, std::vector<HoverImage>& images) {
  constexpr double kPeriod_s = 0.2;
  constexpr double kSlack_s = 1e-3;
  const double t_s = to_seconds(frame.stamp);
  if (!images.empty() && t_s < images.back().t_s + kPeriod_s - kSlack_s) return;
  images.push_back(hover_image(frame));
}

std::vector<std::size_t> longest_first(const HoverConfig& config,
                                       const std::vector<Trial>& trials) {
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return trial_duration_s(config, trials[a]) > trial_duration_s(config, trials[b]);
  });
  return order;
}

}  // namespace

TrialFleet::TrialFleet(const HoverConfig& config, const HoverWorld& world,
                       std::vector<Trial> trials, const std::string& label)
    : config_(config),
      world_(world),
      trials_(std::move(trials)),
      order_(longest_first(config, trials_)),
      records_(trials_.size()),
      images_(trials_.size()),
      progress_(label, static_cast<std::int64_t>(trials_.size())) {}

std::exception_ptr TrialFleet::fly(int jobs) {
  {
    std::vector<std::jthread> threads;
    threads.reserve(static_cast<std::size_t>(jobs));
    for (int i = 0; i < jobs; ++i) threads.emplace_back([this] { fly_pending(); });
  }
  remove_unfinished();
  return failure_;
}

void TrialFleet::fly_pending() {
  try {
    for (std::size_t n = next_++; n < order_.size() && !stopped_; n = next_++) {
      const std::size_t i = order_[n];
      records_[i] = fly_trial(config_, world_, trials_[i], [&](const Frame& frame, auto&&...) {
        if (stopped_ || interrupted()) throw Interrupted{};
        if (is_recorded(i)) append_image(frame, images_[i]);
      });
      const std::scoped_lock lock(mutex_);
      progress_.step();
    }
  } catch (const Interrupted&) {
    stopped_ = true;
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    if (!stopped_.exchange(true)) failure_ = std::current_exception();
  }
}

void TrialFleet::remove_unfinished() {
  for (std::size_t i = records_.size(); i-- > 0;) {
    if (!records_[i].samples.empty()) continue;
    records_.erase(records_.begin() + static_cast<std::ptrdiff_t>(i));
    images_.erase(images_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

// True for the first trial with an estimator along its axis.
bool TrialFleet::is_recorded(std::size_t i) const {
  const auto is_estimated = [&](const Trial& trial) {
    return trial.stabilized || config_.trials.estimate_off;
  };
  return is_estimated(trials_[i]) &&
         std::none_of(trials_.begin(), trials_.begin() + static_cast<std::ptrdiff_t>(i),
                      [&](const Trial& before) {
                        return is_estimated(before) && before.axis == trials_[i].axis;
                      });
}

}  // namespace stillkite
