#pragma once

#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <vector>

#include "flow/frame.hpp"
#include "flow/image_pool.hpp"
#include "live/capture_counts.hpp"
#include "live/record/flight_files.hpp"
#include "live/video/packet_decoder.hpp"

namespace stillkite {

/// Frame that the estimator used in flight, its time, the numbers of images up to it, and the
/// messages that the estimator had received since the previous one.
struct ReplayedFrame {
  Frame frame;
  Timestamp decision;
  CaptureCounts images;
  std::vector<RecordedMessage> telemetry;
};

/// Reads a recorded flight: decodes the packets as in flight and returns the used frames.
class FlightReplay {
 public:
  /// Grey image of a decoded one, stored in the second argument if it fits.
  using GreyOf = std::function<cv::Mat(const AVFrame&, cv::Mat)>;

  /// Throws InputError if a file is missing or damaged.
  FlightReplay(const std::filesystem::path& folder, GreyOf grey_of);

  /// Next used frame; nullopt at the end of the record.
  [[nodiscard]] std::optional<ReplayedFrame> next();

  [[nodiscard]] std::int64_t frames() const { return static_cast<std::int64_t>(frames_.size()); }

 private:
  void select_used_frames();
  const AVFrame* decode_next();
  bool send_packet();
  std::vector<RecordedMessage> messages_until(std::int64_t count);

  GreyOf grey_of_;
  std::vector<RecordedSession> sessions_;
  std::vector<RecordedPacket> packets_;
  std::vector<RecordedFrame> frames_;  // used ones
  std::vector<CaptureCounts> counts_;  // up to each of them
  std::vector<RecordedMessage> messages_;
  std::ifstream video_;
  std::size_t next_packet_ = 0, next_frame_ = 0, next_message_ = 0;
  std::int64_t session_ = -1;
  std::int64_t decoded_ = 0;
  std::optional<PacketDecoder> decoder_;
  LibavHandle<AVPacket> packet_{av_packet_alloc()};
  ImagePool pool_;
};

}  // namespace stillkite
