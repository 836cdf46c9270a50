#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace stillkite {

/// Sends a video as a camera does: H.264 without delay in MPEG-TS over UDP. Each image is complete
/// on the wire when `send` returns.
class VideoSender {
 public:
  /// `url`: udp://HOST:PORT. Throws InputError without an H.264 encoder, for an odd size, and if
  /// the address cannot be opened.
  VideoSender(const std::string& url, cv::Size size, double frames_per_s);
  ~VideoSender();
  VideoSender(const VideoSender&) = delete;
  VideoSender& operator=(const VideoSender&) = delete;

  /// Codes a grey image with its stamp on the sender's clock. Stamps ascend.
  void encode(const cv::Mat& grey, std::int64_t stamp_ns);
  /// Sends the images that have been coded since the last call. An image that the network does not
  /// take is lost.
  void send();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
