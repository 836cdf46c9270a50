#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "live/stream/stream_address.hpp"
#include "live/stream/stream_config.hpp"
#include "live/video/key_frames.hpp"
#include "live/video/libav_handles.hpp"

namespace stillkite {

/// The source cannot be opened, or has no video yet; another attempt may succeed.
class StreamError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The source refuses user and password.
class AccessError : public StreamError {
 public:
  using StreamError::StreamError;
};

enum class StreamStatus { packet, silent, ended };

/// Coded video packets of an open live source. Reading blocks at most for the time-out,
/// from standard input until its end.
class VideoStream {
 public:
  /// Opens the source and waits for its first key frame. `stop` set by another thread ends every
  /// wait. Throws StreamError or AccessError.
  VideoStream(const StreamConfig& config, const std::atomic<bool>& stop);
  ~VideoStream();
  VideoStream(const VideoStream&) = delete;
  VideoStream& operator=(const VideoStream&) = delete;

  /// Next packet of the video. `silent`: none within the time-out, or stopped.
  [[nodiscard]] StreamStatus read(AVPacket& packet);

  [[nodiscard]] const AVCodecParameters& codec() const { return *stream_->codecpar; }
  [[nodiscard]] AVRational time_base() const { return stream_->time_base; }
  /// False for bare streams, whose stamps libavformat invents.
  [[nodiscard]] bool has_time_stamps() const { return has_time_stamps_; }

 private:
  using Clock = std::chrono::steady_clock;

  static int is_over(void* self);
  static int read_standard_input(void* self, std::uint8_t* data, int size);
  void open(const StreamAddress& address);
  void set_deadline(double wait_s);

  StreamConfig config_;
  const std::atomic<bool>& stop_;
  std::atomic<std::int64_t> deadline_ns_ = 0;  // read by libavformat's threads
  LibavHandle<AVIOContext> input_;             // of standard input; used by container_
  LibavHandle<AVFormatContext> container_;
  AVStream* stream_ = nullptr;  // owned by the container
  std::optional<KeyFrames> key_frames_;
  bool has_time_stamps_ = true;
  bool is_silent_ = false;
};

}  // namespace stillkite
