#include "tests/io/video/coded_video.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/log.h>
}

#include <fmt/core.h>

#include <cstring>
#include <stdexcept>

namespace stillkite {
namespace {

int checked(int status, const char* action) {
  if (status < 0)
    throw std::runtime_error(fmt::format("coded video: {} failed: {}", action, status));
  return status;
}

AVFormatContext* create(const std::filesystem::path& file) {
  AVFormatContext* container = nullptr;
  checked(avformat_alloc_output_context2(&container, nullptr, nullptr, file.c_str()), "format");
  checked(avio_open(&container->pb, file.c_str(), AVIO_FLAG_WRITE), "open");
  return container;
}

void finish(AVFormatContext* container) {
  checked(av_write_trailer(container), "trailer");
  avio_closep(&container->pb);
  avformat_free_context(container);
}

AVCodecContext* open_encoder(const CodedVideo& video, bool global_header) {
  const AVCodec* codec = avcodec_find_encoder_by_name(video.codec.c_str());
  if (codec == nullptr) throw std::runtime_error("coded video: no encoder " + video.codec);
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = video.width_px;
  encoder->height = video.height_px;
  encoder->pix_fmt = video.format;
  encoder->time_base = {1, video.rate_hz};
  encoder->framerate = {video.rate_hz, 1};
  encoder->color_range = video.full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  encoder->thread_count = 1;
  encoder->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
  if (global_header) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  if (video.interlaced) encoder->flags |= AV_CODEC_FLAG_INTERLACED_DCT;
  AVDictionary* options = nullptr;
  checked(av_dict_parse_string(&options, video.options.c_str(), "=", ";", 0), "options");
  checked(avcodec_open2(encoder, codec, &options), "encoder");
  checked(av_dict_count(options) == 0 ? 0 : -1, "option");
  av_dict_free(&options);
  return encoder;
}

AVFrame* neutral_frame(const CodedVideo& video) {
  AVFrame* frame = av_frame_alloc();
  frame->format = video.format;
  frame->width = video.width_px;
  frame->height = video.height_px;
  frame->color_range = video.full_range ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  frame->interlaced_frame = video.interlaced ? 1 : 0;
  frame->top_field_first = video.top_field_first ? 1 : 0;
  checked(av_frame_get_buffer(frame, 0), "frame");
  for (int plane = 0; plane < 4 && frame->buf[plane] != nullptr; ++plane) {
    std::memset(frame->buf[plane]->data, 128, frame->buf[plane]->size);
  }
  return frame;
}

void encode(AVCodecContext* encoder, const AVFrame* frame, AVFormatContext* container) {
  checked(avcodec_send_frame(encoder, frame), "encoding");
  AVPacket* packet = av_packet_alloc();
  while (avcodec_receive_packet(encoder, packet) >= 0) {
    packet->duration = 1;
    av_packet_rescale_ts(packet, encoder->time_base, container->streams[0]->time_base);
    checked(av_interleaved_write_frame(container, packet), "writing");
  }
  av_packet_free(&packet);
}

}  // namespace

std::filesystem::path write_coded_video(const std::filesystem::path& file,
                                        const CodedVideo& video) {
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* container = create(file);
  AVCodecContext* encoder =
      open_encoder(video, (container->oformat->flags & AVFMT_GLOBALHEADER) != 0);
  AVStream* stream = avformat_new_stream(container, nullptr);
  checked(avcodec_parameters_from_context(stream->codecpar, encoder), "parameters");
  stream->time_base = encoder->time_base;
  stream->avg_frame_rate = encoder->framerate;
  checked(avformat_write_header(container, nullptr), "header");
  AVFrame* frame = neutral_frame(video);
  for (int i = 0; i < video.frames; ++i) {
    checked(av_frame_make_writable(frame), "frame");
    video.paint(*frame, i);
    frame->pts = i;
    encode(encoder, frame, container);
  }
  encode(encoder, nullptr, container);
  av_frame_free(&frame);
  avcodec_free_context(&encoder);
  finish(container);
  return file;
}

std::filesystem::path join_tracks(const std::filesystem::path& file,
                                  const std::vector<std::filesystem::path>& tracks) {
  AVFormatContext* joined = create(file);
  std::vector<AVFormatContext*> inputs;
  for (const std::filesystem::path& track : tracks) {
    AVFormatContext* input = nullptr;
    checked(avformat_open_input(&input, track.c_str(), nullptr, nullptr), "input");
    checked(avformat_find_stream_info(input, nullptr), "input");
    AVStream* stream = avformat_new_stream(joined, nullptr);
    checked(avcodec_parameters_copy(stream->codecpar, input->streams[0]->codecpar), "parameters");
    stream->codecpar->codec_tag = 0;
    stream->time_base = input->streams[0]->time_base;
    inputs.push_back(input);
  }
  checked(avformat_write_header(joined, nullptr), "header");
  AVPacket* packet = av_packet_alloc();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    while (av_read_frame(inputs[i], packet) >= 0) {
      packet->stream_index = static_cast<int>(i);
      av_packet_rescale_ts(packet, inputs[i]->streams[0]->time_base, joined->streams[i]->time_base);
      checked(av_interleaved_write_frame(joined, packet), "writing");
    }
    avformat_close_input(&inputs[i]);
  }
  av_packet_free(&packet);
  finish(joined);
  return file;
}

}  // namespace stillkite
