#include "live/stream/video_sender.hpp"

extern "C" {
#include <libavutil/opt.h>
}

#include <cstring>
#include <deque>
#include <new>
#include <opencv2/core.hpp>
#include <utility>

#include "geometry/fields.hpp"
#include "live/video/libav_handles.hpp"

namespace stillkite {
namespace {

constexpr AVRational kClock90{1, 90'000};
constexpr AVRational kNs{1, 1'000'000'000};

LibavHandle<AVCodecContext> open_live_encoder(cv::Size size, double frames_per_s) {
  constexpr int kMaxDenominator = 1'000'000;
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr) throw InputError("video: libavcodec has no libx264 encoder");
  LibavHandle<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  encoder->width = size.width;
  encoder->height = size.height;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->color_range = AVCOL_RANGE_JPEG;
  encoder->time_base = kClock90;
  encoder->framerate = av_d2q(frames_per_s, kMaxDenominator);
  encoder->gop_size = static_cast<int>(frames_per_s);
  encoder->thread_count = 1;
  av_opt_set(encoder->priv_data, "preset", "ultrafast", 0);
  av_opt_set(encoder->priv_data, "tune", "zerolatency", 0);
  av_opt_set_double(encoder->priv_data, "crf", 20, 0);
  if (avcodec_open2(encoder.get(), codec, nullptr) < 0) {
    throw InputError("video: x264 does not support images of " + std::to_string(size.width) + "x" +
                     std::to_string(size.height));
  }
  return encoder;
}

}  // namespace

struct VideoSender::State {
  // Of the output, whose connection is not owned by the context.
  struct CloseOutput {
    void operator()(AVFormatContext* context) const {
      avio_closep(&context->pb);
      avformat_free_context(context);
    }
  };
  using Output = std::unique_ptr<AVFormatContext, CloseOutput>;
  static Output open_output(const std::string& url, const AVCodecContext& encoder);

  LibavHandle<AVCodecContext> encoder;
  Output output;
  LibavHandle<AVFrame> frame{av_frame_alloc()};
  std::deque<LibavHandle<AVPacket>> coded;
};

VideoSender::State::Output VideoSender::State::open_output(const std::string& url,
                                                           const AVCodecContext& encoder) {
  AVFormatContext* context = nullptr;
  if (avformat_alloc_output_context2(&context, nullptr, "mpegts", nullptr) < 0) {
    throw std::bad_alloc();
  }
  Output output(context);
  // without lengths the receiver sees the end of an image when the next one begins
  av_opt_set_int(context->priv_data, "omit_video_pes_length", 0, 0);
  context->flags |= AVFMT_FLAG_FLUSH_PACKETS;
  AVStream* stream = avformat_new_stream(context, nullptr);
  if (stream == nullptr) throw std::bad_alloc();
  stream->time_base = kClock90;
  const bool is_open =
      avcodec_parameters_from_context(stream->codecpar, &encoder) >= 0 &&
      avio_open(&context->pb, (url + "?pkt_size=1316").c_str(), AVIO_FLAG_WRITE) >= 0 &&
      avformat_write_header(context, nullptr) >= 0;
  if (!is_open) throw InputError("video: " + url + " cannot be opened; expected udp://HOST:PORT");
  return output;
}

VideoSender::VideoSender(const std::string& url, cv::Size size, double frames_per_s)
    : state_(std::make_unique<State>()) {
  silence_libav();
  State& s = *state_;
  s.encoder = open_live_encoder(size, frames_per_s);
  s.output = State::open_output(url, *s.encoder);
  s.frame->format = AV_PIX_FMT_YUV420P;
  s.frame->color_range = AVCOL_RANGE_JPEG;
  s.frame->width = size.width;
  s.frame->height = size.height;
  if (av_frame_get_buffer(s.frame.get(), 0) < 0) throw std::bad_alloc();
}

VideoSender::~VideoSender() = default;

void VideoSender::encode(const cv::Mat& grey, std::int64_t stamp_ns) {
  State& s = *state_;
  CV_Assert(grey.type() == CV_8UC1);
  if (av_frame_make_writable(s.frame.get()) < 0) throw std::bad_alloc();
  for (int row = 0; row < grey.rows; ++row) {
    std::memcpy(s.frame->data[0] + static_cast<std::ptrdiff_t>(row) * s.frame->linesize[0],
                grey.ptr(row), static_cast<std::size_t>(grey.cols));
  }
  constexpr int kNeutralChroma = 128;
  for (const int plane : {1, 2}) {
    std::memset(s.frame->data[plane], kNeutralChroma,
                static_cast<std::size_t>(s.frame->linesize[plane]) * grey.rows / 2);
  }
  s.frame->pts = av_rescale_q(stamp_ns, kNs, kClock90);
  if (avcodec_send_frame(s.encoder.get(), s.frame.get()) < 0) return;
  while (true) {
    LibavHandle<AVPacket> packet(av_packet_alloc());
    if (avcodec_receive_packet(s.encoder.get(), packet.get()) < 0) return;
    s.coded.push_back(std::move(packet));
  }
}

void VideoSender::send() {
  State& s = *state_;
  for (const LibavHandle<AVPacket>& packet : std::exchange(s.coded, {})) {
    packet->stream_index = 0;
    av_write_frame(s.output.get(), packet.get());
    av_write_frame(s.output.get(), nullptr);  // flushes
  }
}

}  // namespace stillkite
