#pragma once

#include "live/video/libav_handles.hpp"

namespace stillkite {

/// Decodes the packets of one session without delay, on one thread: the same packets give the same
/// images.
class PacketDecoder {
 public:
  /// Throws InputError if there is no decoder for the video.
  explicit PacketDecoder(const AVCodecParameters& parameters);

  /// Sends a packet; false if it is damaged. Packets before the first key frame are discarded:
  /// their images lack the images that they are predicted from.
  bool send(const AVPacket& packet);

  /// Next image, valid until the next call; nullptr if a packet is needed.
  [[nodiscard]] const AVFrame* receive();

  /// True if the image received last is damaged, or predicted from a missing one.
  [[nodiscard]] bool is_damaged() const;

 private:
  LibavHandle<AVCodecContext> decoder_;
  LibavHandle<AVFrame> image_{av_frame_alloc()};
  bool awaits_key_ = true;
};

}  // namespace stillkite
