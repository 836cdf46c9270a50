#include "io/video/video_writer.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

#include <fmt/core.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "io/results/part_file.hpp"

namespace stillkite {
namespace {

struct Free {
  void operator()(AVFormatContext* context) const {
    avio_closep(&context->pb);
    avformat_free_context(context);
  }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

std::string reason(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

Owned<AVCodecContext> open_encoder(cv::Size size, AVRational rate, const EncoderConfig& config) {
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (codec == nullptr) {
    throw InputError("video: libavcodec has no libx264 encoder; write images instead");
  }
  Owned<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  encoder->width = size.width;
  encoder->height = size.height;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->color_range = AVCOL_RANGE_JPEG;
  encoder->colorspace = AVCOL_SPC_SMPTE170M;  // BT.601, as cv::cvtColor
  encoder->time_base = av_inv_q(rate);
  encoder->framerate = rate;
  // x264 output depends on the thread count; fixed for reproducible files
  encoder->thread_count = 4;
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(encoder->priv_data, "preset", std::string(name_of(config.preset)).c_str(), 0);
  av_opt_set_double(encoder->priv_data, "crf", config.crf, 0);
  if (const int error = avcodec_open2(encoder.get(), codec, nullptr); error < 0) {
    throw InputError(fmt::format("video: x264 does not support {}x{} at {:.6g} frames/s: {}",
                                 size.width, size.height, av_q2d(rate), reason(error)));
  }
  return encoder;
}

Owned<AVFrame> neutral_frame(cv::Size size) {
  Owned<AVFrame> frame(av_frame_alloc());
  frame->format = AV_PIX_FMT_YUV420P;
  frame->color_range = AVCOL_RANGE_JPEG;
  frame->width = size.width;
  frame->height = size.height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  for (const int plane : {1, 2}) {
    std::memset(frame->data[plane], 128,
                static_cast<std::size_t>(frame->linesize[plane]) * size.height / 2);
  }
  return frame;
}

}  // namespace

struct VideoWriter::State {
  explicit State(const std::filesystem::path& file) : part(file) {}

  PartFile part;
  cv::Size size;
  Owned<AVCodecContext> encoder;
  Owned<AVFormatContext> container;
  AVStream* stream = nullptr;
  Owned<AVFrame> frame;
  Owned<AVPacket> packet{av_packet_alloc()};
  std::int64_t frames = 0;
  bool finished = false;

  void check(int status) const {
    if (status >= 0) return;
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}; free some space or choose another folder with "
                    "--out",
                    part.file().string(), reason(status)));
  }
  void fill(int plane, const cv::Mat& values);
  void encode(const AVFrame* image);
};

VideoWriter::VideoWriter(const std::filesystem::path& file, cv::Size size, double frames_per_s,
                         const EncoderConfig& config)
    : state_(std::make_unique<State>(file)) {
  if (size.width % 2 != 0 || size.height % 2 != 0 || size.empty()) {
    throw InputError(fmt::format("{}: H.264 needs an even width and height, not {}x{}",
                                 file.string(), size.width, size.height));
  }
  if (av_log_get_level() == AV_LOG_INFO) av_log_set_level(AV_LOG_QUIET);
  State& s = *state_;
  s.size = size;
  constexpr int kMaxDenominator = 1'000'000;
  s.encoder = open_encoder(size, av_d2q(frames_per_s, kMaxDenominator), config);
  s.frame = neutral_frame(size);

  AVFormatContext* container = nullptr;
  if (avformat_alloc_output_context2(&container, nullptr, nullptr, file.c_str()) < 0) {
    throw InputError(file.string() + ": unknown video format; use .mp4 or .mkv");
  }
  s.container.reset(container);
  if (const int error = avio_open(&container->pb, s.part.path().c_str(), AVIO_FLAG_WRITE);
      error < 0) {
    throw InputError(fmt::format("{}: cannot be created: {}; choose another folder with --out",
                                 file.string(), reason(error)));
  }
  s.stream = avformat_new_stream(container, nullptr);
  if (s.stream == nullptr) throw std::bad_alloc();
  s.stream->time_base = s.encoder->time_base;
  s.stream->avg_frame_rate = s.encoder->framerate;
  s.check(avcodec_parameters_from_context(s.stream->codecpar, s.encoder.get()));
  s.check(avformat_write_header(container, nullptr));
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

// nullptr flushes the encoder.
void VideoWriter::State::encode(const AVFrame* image) {
  check(avcodec_send_frame(encoder.get(), image));
  for (;;) {
    const int status = avcodec_receive_packet(encoder.get(), packet.get());
    if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
    check(status);
    packet->duration = 1;
    av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
    check(av_interleaved_write_frame(container.get(), packet.get()));
    // the buffered writer reports write errors here only
    check(container->pb->error);
  }
}

void VideoWriter::State::fill(int plane, const cv::Mat& values) {
  for (int row = 0; row < values.rows; ++row) {
    std::memcpy(frame->data[plane] + static_cast<std::ptrdiff_t>(row) * frame->linesize[plane],
                values.ptr(row), static_cast<std::size_t>(values.cols));
  }
}

void VideoWriter::write(const cv::Mat& image) {
  CV_Assert(image.type() == CV_8UC1 || image.type() == CV_8UC3);
  CV_Assert(image.size() == state_->size);
  State& s = *state_;
  s.check(av_frame_make_writable(s.frame.get()));
  if (image.channels() == 1) {
    s.fill(0, image);
  } else {
    std::array<cv::Mat, 3> planes;  // Y, Cr, Cb
    cv::Mat ycrcb;
    cv::cvtColor(image, ycrcb, cv::COLOR_BGR2YCrCb);
    cv::split(ycrcb, planes.data());
    s.fill(0, planes[0]);
    for (const auto& [plane, source] : {std::pair{1, 2}, std::pair{2, 1}}) {
      cv::Mat half;
      cv::resize(planes[static_cast<std::size_t>(source)], half, s.size / 2, 0, 0, cv::INTER_AREA);
      s.fill(plane, half);
    }
  }
  s.frame->pts = s.frames++;
  s.encode(s.frame.get());
}

void VideoWriter::finish() {
  State& s = *state_;
  if (s.finished) return;
  s.encode(nullptr);
  s.check(av_write_trailer(s.container.get()));
  s.check(avio_closep(&s.container->pb));
  s.finished = true;
}

void VideoWriter::commit() {
  finish();
  state_->part.rename();
}

}  // namespace stillkite
