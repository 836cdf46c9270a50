#include "io/video/video_reader.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "geometry/fields.hpp"
#include "io/video/display_rotation.hpp"
#include "io/video/luma.hpp"

namespace stillkite {
namespace {

struct Free {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
template <typename T>
using Owned = std::unique_ptr<T, Free>;

constexpr AVRational kNanoseconds{1, 1'000'000'000};

Owned<AVFormatContext> open_container(const std::string& name) {
  AVDictionary* options = nullptr;
  // no network access by play lists
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  AVFormatContext* context = nullptr;
  const int error = avformat_open_input(&context, name.c_str(), nullptr, &options);
  av_dict_free(&options);
  if (error < 0) {
    throw InputError(name +
                     ": not a video file, or its header or index is missing (interrupted recording "
                     "or download)");
  }
  Owned<AVFormatContext> container(context);
  if (avformat_find_stream_info(context, nullptr) < 0) {
    throw InputError(name + ": cannot read the streams; the file is damaged");
  }
  return container;
}

Owned<AVCodecContext> open_decoder(const AVStream& stream, const AVCodec* codec,
                                   const std::string& name) {
  Owned<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  decoder->thread_count = 0;  // one per core
  if (avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0 ||
      avcodec_open2(decoder.get(), codec, nullptr) < 0) {
    throw InputError(fmt::format("{}: the {} decoder does not support this video", name,
                                 avcodec_get_name(stream.codecpar->codec_id)));
  }
  return decoder;
}

std::optional<cv::RotateFlags> stored_rotation(const AVStream& stream, const std::string& name) {
  std::array<std::int32_t, 9> matrix{};
  std::size_t bytes = 0;
  const std::uint8_t* mark = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
  if (mark == nullptr || bytes < sizeof(matrix)) return std::nullopt;
  std::memcpy(matrix.data(), mark, sizeof(matrix));
  return display_rotation(matrix, name);
}

}  // namespace

struct VideoReader::State {
  std::string name;
  Timestamp start;
  std::optional<double> rate_hz;
  Owned<AVFormatContext> container;
  AVStream* stream = nullptr;
  Owned<AVCodecContext> decoder;
  Owned<AVPacket> packet{av_packet_alloc()};
  Owned<AVFrame> image{av_frame_alloc()};
  LumaExtractor luma;
  std::optional<cv::RotateFlags> rotation;
  cv::Mat coded_grey;  // before rotation
  cv::Size size;
  std::int64_t images = 0;
  Timestamp last;
  bool sent_all = false;

  Timestamp stamp_of_image();
  bool send_packet();
  [[nodiscard]] cv::Size size_of_image() const;
  cv::Mat grey_of_image(cv::Mat recycled);
};

VideoReader::VideoReader(const std::filesystem::path& file, double start_s,
                         std::optional<double> rate_hz)
    : state_(std::make_unique<State>()) {
  // damage is reported once by FrameSource; keeps a log level set by the application
  if (av_log_get_level() == AV_LOG_INFO) av_log_set_level(AV_LOG_QUIET);
  State& s = *state_;
  s.name = file.string();
  s.start = from_seconds(start_s);
  s.rate_hz = rate_hz;
  s.container = open_container(s.name);
  const AVCodec* codec = nullptr;
  const int index = av_find_best_stream(s.container.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  if (index < 0 || codec == nullptr) {
    throw InputError(s.name + ": no video stream that can be decoded");
  }
  s.stream = s.container->streams[index];
  s.decoder = open_decoder(*s.stream, codec, s.name);
  s.rotation = stored_rotation(*s.stream, s.name);
  for (unsigned i = 0; i < s.container->nb_streams; ++i) {
    if (static_cast<int>(i) != index) s.container->streams[i]->discard = AVDISCARD_ALL;
  }
  if (start_s > 0 && !rate_hz) {  // stamps by rate_hz count all images
    const std::int64_t first = s.stream->start_time == AV_NOPTS_VALUE ? 0 : s.stream->start_time;
    const std::int64_t target = first + av_rescale_q(s.start.ns, kNanoseconds, s.stream->time_base);
    av_seek_frame(s.container.get(), index, target, AVSEEK_FLAG_BACKWARD);
  }
}

VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

// Decoder stamp, else last stamp + 1 / frame rate.
Timestamp VideoReader::State::stamp_of_image() {
  if (rate_hz) return from_seconds(static_cast<double>(images) / *rate_hz);
  if (image->best_effort_timestamp != AV_NOPTS_VALUE) {
    const std::int64_t first = stream->start_time == AV_NOPTS_VALUE ? 0 : stream->start_time;
    return {av_rescale_q(image->best_effort_timestamp - first, stream->time_base, kNanoseconds)};
  }
  const AVRational rate = stream->avg_frame_rate;
  if (rate.num <= 0 || rate.den <= 0) {
    throw InputError(name + ": neither time stamps nor a frame rate; set source.rate_hz");
  }
  return images == 0 ? Timestamp{0}
                     : Timestamp{last.ns + av_rescale_q(1, av_inv_q(rate), kNanoseconds)};
}

// Sends a packet to the decoder; false if it is damaged.
bool VideoReader::State::send_packet() {
  const int status = av_read_frame(container.get(), packet.get());
  if (status == AVERROR(EAGAIN)) return true;
  if (status < 0) {
    sent_all = true;
    avcodec_send_packet(decoder.get(), nullptr);
    return true;
  }
  const bool ours = packet->stream_index == stream->index;
  const int sent = ours ? avcodec_send_packet(decoder.get(), packet.get()) : 0;
  av_packet_unref(packet.get());
  return sent >= 0;
}

cv::Size VideoReader::State::size_of_image() const {
  const cv::Size coded_size(image->width, image->height);
  const bool keeps_width = !rotation || *rotation == cv::ROTATE_180;
  return keeps_width ? coded_size : cv::Size(coded_size.height, coded_size.width);
}

cv::Mat VideoReader::State::grey_of_image(cv::Mat recycled) {
  if (!rotation) return luma.extract(*image, std::move(recycled));
  coded_grey = luma.extract(*image, std::move(coded_grey));
  if (coded_grey.empty()) return {};
  cv::rotate(coded_grey, recycled, *rotation);
  return recycled;
}

ReadResult VideoReader::read(cv::Mat recycled) {
  State& s = *state_;
  while (true) {
    const int status = avcodec_receive_frame(s.decoder.get(), s.image.get());
    if (status == AVERROR_EOF) return {};
    if (status == AVERROR(EAGAIN)) {
      if (!s.send_packet()) return {.status = ReadResult::Status::undecodable};
      continue;
    }
    if (status < 0) {
      // after the last packet a failing decoder never returns AVERROR_EOF
      if (s.sent_all) return {};
      return {.status = ReadResult::Status::undecodable};
    }
    const Timestamp stamp = s.stamp_of_image();
    ++s.images;
    s.last = stamp;
    if (stamp < s.start) continue;
    if (s.image->decode_error_flags != 0 || (s.image->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
      return {.status = ReadResult::Status::undecodable};
    }
    const cv::Size size = s.size_of_image();
    if (s.size.area() > 0 && size != s.size) {
      throw InputError(fmt::format(
          "{}: image size {}x{} at {:.3f} s differs from {}x{} before; one calibration needs one "
          "size, end the run there (source.end_s)",
          s.name, size.width, size.height, to_seconds(stamp), s.size.width, s.size.height));
    }
    s.size = size;
    cv::Mat grey = s.grey_of_image(std::move(recycled));
    if (grey.empty()) return {.status = ReadResult::Status::undecodable};
    return {.status = ReadResult::Status::frame,
            .frame = {.stamp = stamp, .grey = std::move(grey)}};
  }
}

bool VideoReader::is_rotated() const {
  return state_->rotation.has_value();
}

std::optional<std::string> VideoReader::non_square_pixels() const {
  constexpr double kRounding = 0.01;
  const State& s = *state_;
  const AVRational aspect = av_guess_sample_aspect_ratio(s.container.get(), s.stream, nullptr);
  if (aspect.num <= 0 || aspect.den <= 0 || std::abs(av_q2d(aspect) - 1) < kRounding) {
    return std::nullopt;
  }
  return fmt::format(
      "{}: non-square pixels, aspect ratio {}:{}; images are not rescaled, the calibration must be "
      "of "
      "the coded images",
      s.name, aspect.num, aspect.den);
}

std::optional<double> VideoReader::duration_s() const {
  const State& s = *state_;
  if (s.stream->duration != AV_NOPTS_VALUE) {
    return static_cast<double>(s.stream->duration) * av_q2d(s.stream->time_base);
  }
  // the container's duration may be that of an audio stream
  if (s.container->nb_streams > 1 || s.container->duration == AV_NOPTS_VALUE) return std::nullopt;
  return static_cast<double>(s.container->duration) / AV_TIME_BASE;
}

std::optional<double> VideoReader::frames_per_s() const {
  if (state_->rate_hz) return state_->rate_hz;
  const AVRational rate = state_->stream->avg_frame_rate;
  if (rate.num <= 0 || rate.den <= 0) return std::nullopt;
  return av_q2d(rate);
}

std::optional<std::string> VideoReader::truncation() const {
  const State& s = *state_;
  const std::optional<double> duration = duration_s();
  const std::optional<double> rate = frames_per_s();
  if (!s.sent_all || s.rate_hz || !duration || !rate) return std::nullopt;
  const double end_s = to_seconds(s.last) + 1.0 / *rate;
  // tolerance of 3 frames for rounding and variable frame rate
  if (end_s + 3.0 / *rate >= *duration) return std::nullopt;
  return fmt::format("{}: truncated file: images end at {:.2f} s of {:.2f} s", s.name, end_s,
                     *duration);
}

}  // namespace stillkite
