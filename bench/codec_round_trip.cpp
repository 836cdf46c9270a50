#include "codec_round_trip.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "geometry/fields.hpp"

namespace stillkite::bench {
namespace {

struct Free {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

void check(int status, const char* step) {
  if (status >= 0) return;
  throw std::runtime_error(fmt::format("{} failed with libav error {}", step, status));
}

double mean_rate_hz(const std::vector<RecordedImage>& images) {
  return static_cast<double>(images.size() - 1) /
         seconds_between(images.front().stamp, images.back().stamp);
}

Owned<AVCodecContext> open_encoder(const AVCodec* codec, cv::Size size, double rate_hz,
                                   double bits_per_pixel) {
  Owned<AVCodecContext> context(avcodec_alloc_context3(codec));
  context->width = size.width;
  context->height = size.height;
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->color_range = AVCOL_RANGE_JPEG;
  context->framerate = av_d2q(rate_hz, 1000);
  context->time_base = av_inv_q(context->framerate);
  context->bit_rate = std::llround(bits_per_pixel * size.area() * rate_hz);
  context->gop_size = static_cast<int>(std::lround(rate_hz));
  context->max_b_frames = 0;  // as a live link
  context->thread_count = 1;  // the output depends on it
  av_opt_set(context->priv_data, "preset", "veryfast", 0);
  av_opt_set(context->priv_data, "tune", "zerolatency", 0);
  av_opt_set(context->priv_data, "x265-params", "log-level=none:pools=1:frame-threads=1", 0);
  check(avcodec_open2(context.get(), codec, nullptr), "opening the encoder");
  return context;
}

Owned<AVCodecContext> open_decoder(AVCodecID id) {
  const AVCodec* codec = avcodec_find_decoder(id);
  if (codec == nullptr) throw InputError("libavcodec has no decoder of its own encoder's format");
  Owned<AVCodecContext> context(avcodec_alloc_context3(codec));
  context->thread_count = 1;
  check(avcodec_open2(context.get(), codec, nullptr), "opening the decoder");
  return context;
}

// Luma of an even size; chroma is neutral.
Owned<AVFrame> frame_of(const cv::Mat& grey, std::int64_t pts) {
  cv::Mat even;
  cv::copyMakeBorder(grey, even, 0, grey.rows % 2, 0, grey.cols % 2, cv::BORDER_REPLICATE);
  Owned<AVFrame> frame(av_frame_alloc());
  frame->format = AV_PIX_FMT_YUV420P;
  frame->color_range = AVCOL_RANGE_JPEG;
  frame->width = even.cols;
  frame->height = even.rows;
  frame->pts = pts;
  check(av_frame_get_buffer(frame.get(), 0), "allocating a frame");
  const auto plane = [&](int i, int rows, int columns) {
    return cv::Mat(rows, columns, CV_8UC1, frame->data[i],
                   static_cast<std::size_t>(frame->linesize[i]));
  };
  even.copyTo(plane(0, even.rows, even.cols));
  for (const int i : {1, 2}) plane(i, even.rows / 2, even.cols / 2) = 128;
  return frame;
}

/// Encoder and decoder in a row; images come out in their order.
class RoundTrip {
 public:
  RoundTrip(Owned<AVCodecContext> encoder, cv::Size size)
      : encoder_(std::move(encoder)), decoder_(open_decoder(encoder_->codec_id)), size_(size) {}

  /// nullptr flushes.
  void send(const AVFrame* frame) {
    check(avcodec_send_frame(encoder_.get(), frame), "encoding");
    while (avcodec_receive_packet(encoder_.get(), packet_.get()) >= 0) {
      check(avcodec_send_packet(decoder_.get(), packet_.get()), "decoding");
      av_packet_unref(packet_.get());
      receive();
    }
    if (frame != nullptr) return;
    check(avcodec_send_packet(decoder_.get(), nullptr), "decoding");
    receive();
  }
  [[nodiscard]] const std::vector<cv::Mat>& images() const { return images_; }

 private:
  void receive() {
    while (avcodec_receive_frame(decoder_.get(), frame_.get()) >= 0) {
      images_.push_back(
          cv::Mat(size_, CV_8UC1, frame_->data[0], static_cast<std::size_t>(frame_->linesize[0]))
              .clone());
    }
  }

  Owned<AVCodecContext> encoder_, decoder_;
  Owned<AVPacket> packet_{av_packet_alloc()};
  Owned<AVFrame> frame_{av_frame_alloc()};
  cv::Size size_;
  std::vector<cv::Mat> images_;
};

}  // namespace

Recording with_codec(const Recording& recording, const std::string& encoder,
                     double bits_per_pixel) {
  const AVCodec* codec = avcodec_find_encoder_by_name(encoder.c_str());
  if (codec == nullptr) throw InputError("libavcodec has no encoder " + encoder);
  av_log_set_level(AV_LOG_ERROR);
  const cv::Size size = recording.images.front().grey.size();
  const cv::Size even(size.width + size.width % 2, size.height + size.height % 2);
  RoundTrip round_trip(open_encoder(codec, even, mean_rate_hz(recording.images), bits_per_pixel),
                       size);
  for (std::size_t i = 0; i < recording.images.size(); ++i) {
    const Owned<AVFrame> frame = frame_of(recording.images[i].grey, static_cast<std::int64_t>(i));
    round_trip.send(frame.get());
  }
  round_trip.send(nullptr);
  if (round_trip.images().size() != recording.images.size()) {
    throw std::runtime_error(fmt::format("{}: {} of {} images decoded", encoder,
                                         round_trip.images().size(), recording.images.size()));
  }
  Recording out = recording;
  for (std::size_t i = 0; i < out.images.size(); ++i) out.images[i].grey = round_trip.images()[i];
  return out;
}

}  // namespace stillkite::bench
