#include "live/video/packet_decoder.hpp"

#include <fmt/format.h>

#include "geometry/fields.hpp"

namespace stillkite {

PacketDecoder::PacketDecoder(const AVCodecParameters& parameters) {
  silence_libav();
  const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
  decoder_.reset(avcodec_alloc_context3(codec));
  if (codec == nullptr || avcodec_parameters_to_context(decoder_.get(), &parameters) < 0) {
    throw InputError(
        fmt::format("source.path: no decoder for {} video", avcodec_get_name(parameters.codec_id)));
  }
  decoder_->thread_count = 1;
  decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY;
  if (avcodec_open2(decoder_.get(), codec, nullptr) < 0) {
    throw InputError(fmt::format("source.path: the {} decoder does not support this video",
                                 avcodec_get_name(parameters.codec_id)));
  }
}

bool PacketDecoder::send(const AVPacket& packet) {
  if (awaits_key_ && (packet.flags & AV_PKT_FLAG_KEY) == 0) return true;
  awaits_key_ = false;
  return avcodec_send_packet(decoder_.get(), &packet) >= 0;
}

const AVFrame* PacketDecoder::receive() {
  return avcodec_receive_frame(decoder_.get(), image_.get()) >= 0 ? image_.get() : nullptr;
}

bool PacketDecoder::is_damaged() const {
  return image_->decode_error_flags != 0 || (image_->flags & AV_FRAME_FLAG_CORRUPT) != 0;
}

}  // namespace stillkite
