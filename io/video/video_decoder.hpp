#pragma once

#include <optional>
#include <string>

#include "geometry/time.hpp"
#include "io/video/read_result.hpp"
#include "io/video/video_track.hpp"

namespace stillkite {

/// Images of one video track. Packets before the first key frame are discarded: their images lack
/// the images that they are predicted from.
class VideoDecoder {
 public:
  /// Opens the file at its beginning; errors as open_video_track.
  VideoDecoder(const std::string& file, std::optional<int> track);

  /// Decodes the next image.
  [[nodiscard]] ReadResult::Status next();

  /// Decodes the next image, which next() returns again; false at the end.
  bool peek();

  /// Continues at a key frame that is not after `start`, right after the file is opened.
  void seek(Timestamp start);

  /// Image decoded last.
  [[nodiscard]] AVFrame& image() { return *image_; }
  /// Its stamp relative to the first image of the file; nullopt if the file has none.
  [[nodiscard]] std::optional<Timestamp> stamp() const;

  [[nodiscard]] const VideoTrack& track() const { return track_; }
  [[nodiscard]] bool read_all() const { return sent_all_; }

 private:
  void reset();
  bool send_packet();
  [[nodiscard]] std::optional<Timestamp> stamp_of(std::int64_t coded) const;

  std::string file_;
  std::optional<int> number_;
  VideoTrack track_;
  LibavInput<AVPacket> packet_{av_packet_alloc()};
  LibavInput<AVFrame> image_{av_frame_alloc()};
  std::optional<Timestamp> key_;  // first key frame
  bool awaits_key_ = true;
  bool peeked_ = false;
  bool sent_all_ = false;
};

}  // namespace stillkite
