#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "app/page_snapshot.hpp"
#include "io/video/overlay.hpp"
#include "live/page/page_server.hpp"

namespace stillkite {

/// JPEG of the newest image with flow, horizon and velocity, at most 800 px wide and ten per
/// second, shared by all who watch. Thread-safe.
class PageImageEncoder {
 public:
  /// Image of the snapshot. nullopt if its number is not above `after`; the last one if it was
  /// coded less than 0.1 s ago.
  [[nodiscard]] std::optional<PageImage> encode(const PageSnapshot& snapshot, std::int64_t after,
                                                Timestamp now);

 private:
  [[nodiscard]] std::vector<std::uint8_t> draw(const PageSnapshot& snapshot);

  std::mutex mutex_;
  std::optional<Overlay> overlay_;
  PageImage last_{.number = -1, .jpeg = nullptr};
  Timestamp coded_;
};

}  // namespace stillkite
