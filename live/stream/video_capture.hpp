#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "flow/frame.hpp"
#include "flow/image_pool.hpp"
#include "live/capture_counts.hpp"
#include "live/clock/clock_map.hpp"
#include "live/record/flight_record.hpp"
#include "live/stream/mailbox.hpp"
#include "live/stream/stream_config.hpp"
#include "live/stream/video_stream.hpp"
#include "live/video/packet_decoder.hpp"

namespace stillkite {

/// Captured frame with the arrival of its packet.
struct CapturedFrame {
  Frame frame;
  Timestamp arrival;
};

/// Captures a live video on its own thread: decodes every image and keeps only the newest. Opens
/// the source again when it is silent or ends, with increasing pauses. Stamps are those of the
/// sender on the local monotonic clock (ClockMap); bare streams are stamped on arrival
/// (StampFilter).
class VideoCapture {
 public:
  /// Grey image of a decoded one, stored in the second argument if it fits; called on the capture
  /// thread.
  using GreyOf = std::function<cv::Mat(const AVFrame&, cv::Mat)>;
  /// Receives one line for each change of state; called on the capture thread.
  using Report = std::function<void(const std::string&)>;

  /// `record` may be null. Throws InputError if the address is invalid.
  VideoCapture(const StreamConfig& config, GreyOf grey_of, Report report, FlightRecord* record);
  ~VideoCapture();
  VideoCapture(const VideoCapture&) = delete;
  VideoCapture& operator=(const VideoCapture&) = delete;

  /// Newest frame that was not returned before; waits at most `wait_s`. Stamps ascend.
  [[nodiscard]] std::optional<CapturedFrame> next(double wait_s) { return newest_.take(wait_s); }

  /// True after the end of standard input, once its last frame is taken, and after a failure.
  [[nodiscard]] bool has_ended() { return newest_.is_closed_and_empty(); }
  /// Failure that ended the capture: no decoder, unsupported pixel format. Valid once ended.
  [[nodiscard]] const std::exception_ptr& failure() const { return failure_; }

  [[nodiscard]] CaptureCounts counts() const;

 private:
  struct Session;
  void capture_all();
  void capture_session(VideoStream& stream);
  void deliver(Session& session, const AVFrame& image, bool is_damaged, Timestamp arrival);
  void reject(std::int64_t index, FrameOutcome outcome, const FilteredStamp& stamp = {});
  void pause(double pause_s) const;

  StreamConfig config_;
  std::string name_;  // of the source, for messages
  bool reopens_;
  GreyOf grey_of_;
  Report report_;
  FlightRecord* record_;
  Mailbox<CapturedFrame> newest_;
  ImagePool pool_;
  std::optional<Timestamp> last_stamp_;
  cv::Size size_;
  bool has_reported_size_ = false;
  std::atomic<std::int64_t> decoded_ = 0, replaced_ = 0, rejected_ = 0, sessions_ = 0;
  std::exception_ptr failure_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;  // last: uses all other members
};

}  // namespace stillkite
