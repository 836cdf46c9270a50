#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "app/message_log.hpp"
#include "app/page_history.hpp"
#include "app/page_image_encoder.hpp"
#include "app/page_snapshot.hpp"
#include "app/page_state.hpp"
#include "live/live_config.hpp"
#include "live/page/page_server.hpp"

namespace stillkite {

/// Operator's page of a live flight. The estimator's thread publishes the newest state and never
/// waits; texts and images are made on the page's threads, images only while somebody watches.
class FlightPage {
 public:
  /// `operators` receives the commands, null without a ground station; both pointers outlive the
  /// page. Token: from the environment. Throws InputError that names live.listen.
  FlightPage(const LiveConfig& live, OperatorQueue* operators, MessageLog& messages,
             PageServer::Report report);

  /// State without an image.
  void publish(const FlightStatus& status);
  /// Newest estimate; `number` and `measured` are set here.
  void publish(PageSnapshot snapshot, const FlightStatus& status);

  /// True if an image was requested in the last second.
  [[nodiscard]] bool is_watched() const;

  [[nodiscard]] int port() const { return server_->port(); }

 private:
  [[nodiscard]] PageState state(std::int64_t after) const;
  [[nodiscard]] std::optional<PageImage> image(std::int64_t after);

  MessageLog& messages_;
  Timestamp start_;
  // Estimator's thread.
  PageHistory history_;
  std::vector<HistorySample> waiting_;
  std::optional<Timestamp> measured_;
  std::int64_t number_ = 0;
  // All threads.
  mutable std::mutex mutex_;
  std::shared_ptr<const PageSnapshot> newest_;
  FlightStatus status_;
  std::deque<HistorySample> samples_;
  std::atomic<std::int64_t> image_request_ns_ = 0;
  PageImageEncoder encoder_;
  std::optional<PageServer> server_;  // last: its threads use all other members
};

}  // namespace stillkite
