#pragma once

#include "live/video/libav_handles.hpp"

namespace stillkite {

/// Finds the key frames among packets that hold one image each, without the delay of libavformat's
/// own parser.
class KeyFrames {
 public:
  explicit KeyFrames(const AVCodecParameters& parameters);

  /// Sets or keeps AV_PKT_FLAG_KEY.
  void mark(AVPacket& packet);

 private:
  struct CloseParser {
    void operator()(AVCodecParserContext* parser) const { av_parser_close(parser); }
  };
  LibavHandle<AVCodecContext> codec_;
  std::unique_ptr<AVCodecParserContext, CloseParser> parser_;  // null: every packet is a key frame
};

}  // namespace stillkite
