#include "live/video/key_frames.hpp"

#include <new>

namespace stillkite {

KeyFrames::KeyFrames(const AVCodecParameters& parameters)
    : codec_(avcodec_alloc_context3(nullptr)) {
  if (!codec_ || avcodec_parameters_to_context(codec_.get(), &parameters) < 0) {
    throw std::bad_alloc();
  }
  const AVCodecDescriptor* descriptor = avcodec_descriptor_get(parameters.codec_id);
  if (descriptor != nullptr && (descriptor->props & AV_CODEC_PROP_INTRA_ONLY) != 0) return;
  parser_.reset(av_parser_init(parameters.codec_id));
  if (parser_) parser_->flags |= PARSER_FLAG_COMPLETE_FRAMES;
}

void KeyFrames::mark(AVPacket& packet) {
  bool is_key = !parser_;
  if (parser_) {
    std::uint8_t* parsed = nullptr;
    int parsed_bytes = 0;
    av_parser_parse2(parser_.get(), codec_.get(), &parsed, &parsed_bytes, packet.data, packet.size,
                     packet.pts, packet.dts, packet.pos);
    is_key = parser_->key_frame == 1;
  }
  if (is_key) packet.flags |= AV_PKT_FLAG_KEY;
}

}  // namespace stillkite
