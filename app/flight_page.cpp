#include "app/flight_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "live/clock/local_clock.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMaxPageSamples = 1200;  // 5 min
constexpr std::int64_t kRateSamples = 44;      // 11 s, for the rates of images

}  // namespace

FlightPage::FlightPage(const LiveConfig& live, OperatorQueue* operators, MessageLog& messages,
                       PageServer::Report report)
    : messages_(messages), start_(local_now()) {
  const PageAddress address = parse_page_address(live.listen.value());
  const PageAccess access = page_access(address, live.public_host, std::getenv(kPageToken));
  const PageServer::Report started = report;
  server_.emplace(address, access,
                  PageContent{.state =
                                  [this](std::int64_t after) {
                                    return page_json(state(after), local_now(), after)
                                        .dump(-1, ' ', false,
                                              nlohmann::json::error_handler_t::replace);
                                  },
                              .image = [this](std::int64_t after) { return image(after); }},
                  operators, std::move(report));
  const bool is_ipv6 = address.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + address.host + "]" : address.host;
  started(fmt::format("page: http://{}:{}/", host, server_->port()));
}

// The page shows the next state instead of this one if a thread of the page holds the lock.
void FlightPage::publish(const FlightStatus& status) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock) status_ = status;
}

void FlightPage::publish(PageSnapshot snapshot, const FlightStatus& status) {
  if (is_measured(snapshot.step.estimate.verdict)) measured_ = snapshot.estimated;
  snapshot.measured = measured_;
  snapshot.number = ++number_;
  history_.add(history_sample(snapshot, status));
  for (const HistorySample& sample : history_.take()) waiting_.push_back(sample);
  auto newest = std::make_shared<const PageSnapshot>(std::move(snapshot));
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  newest_.swap(newest);
  status_ = status;
  samples_.insert(samples_.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
  while (samples_.size() > kMaxPageSamples) samples_.pop_front();
}

bool FlightPage::is_watched() const {
  constexpr double kWatched_s = 1;
  return seconds_between({image_request_ns_}, local_now()) < kWatched_s;
}

PageState FlightPage::state(std::int64_t after) const {
  PageState out;
  out.flight = start_.ns;
  {
    const std::lock_guard lock(mutex_);
    out.newest = newest_;
    out.status = status_;
    const std::int64_t last = samples_.empty() ? -1 : samples_.back().number;
    const auto first = std::ranges::upper_bound(samples_, std::min(after, last - kRateSamples), {},
                                                &HistorySample::number);
    out.samples.assign(first, samples_.end());
  }
  out.messages = messages_.messages();
  return out;
}

std::optional<PageImage> FlightPage::image(std::int64_t after) {
  image_request_ns_ = local_now().ns;
  std::shared_ptr<const PageSnapshot> newest;
  {
    const std::lock_guard lock(mutex_);
    newest = newest_;
  }
  if (!newest) return std::nullopt;
  return encoder_.encode(*newest, after, local_now());
}

}  // namespace stillkite
