#include "io/video/video_reader.hpp"

extern "C" {
#include <libavutil/log.h>
}

#include <fmt/core.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "geometry/fields.hpp"
#include "io/video/interlacing.hpp"
#include "io/video/luma.hpp"
#include "io/video/video_decoder.hpp"

namespace stillkite {
struct VideoReader::State {
  explicit State(const SourceConfig& source)
      : config(source),
        name(source.path.string()),
        start(from_seconds(source.start_s)),
        rate_hz(source.rate_hz),
        decoder(name, source.track),
        rotation(stored_rotation(decoder.track(), name)),
        luma(name, source.bits) {}

  SourceConfig config;
  std::string name;
  Timestamp start;
  std::optional<double> rate_hz;  // if images are stamped by counting
  VideoDecoder decoder;
  std::optional<cv::RotateFlags> rotation;
  LumaExtractor luma;
  cv::Mat coded_grey;  // before rotation
  cv::Size size;
  std::int64_t images = 0;
  Timestamp last;

  [[nodiscard]] Timestamp stamp_of_image() const;
  [[nodiscard]] cv::Size size_of_image();
  cv::Mat grey_of_image(std::optional<Field> field, cv::Mat recycled);
};

VideoReader::VideoReader(const SourceConfig& config) {
  // damage is reported once by FrameSource; keeps a log level set by the application
  if (av_log_get_level() == AV_LOG_INFO) av_log_set_level(AV_LOG_QUIET);
  state_ = std::make_unique<State>(config);
  State& s = *state_;
  if (!s.rate_hz && has_no_time_stamps(s.decoder.track())) {
    if (s.decoder.peek()) s.rate_hz = coded_rate_hz(s.decoder.track());
    if (!s.rate_hz) {
      throw InputError(s.name +
                       ": the file has no time stamps and no frame rate; set it as source.rate_hz");
    }
  }
  // stamps by rate_hz count all images
  if (config.start_s > 0 && !s.rate_hz) s.decoder.seek(s.start);
}

VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

// Decoder stamp, else last stamp + 1 / frame rate.
Timestamp VideoReader::State::stamp_of_image() const {
  if (rate_hz) return from_seconds(static_cast<double>(images) / *rate_hz);
  if (const auto stamp = decoder.stamp()) return *stamp;
  const AVRational rate = decoder.track().stream->avg_frame_rate;
  if (rate.num <= 0 || rate.den <= 0) {
    throw InputError(name + ": neither time stamps nor a frame rate; set source.rate_hz");
  }
  return images == 0 ? Timestamp{0} : Timestamp{last.ns + from_seconds(1.0 / av_q2d(rate)).ns};
}

cv::Size VideoReader::State::size_of_image() {
  const cv::Size coded_size(decoder.image().width, decoder.image().height);
  const bool keeps_width = !rotation || *rotation == cv::ROTATE_180;
  return keeps_width ? coded_size : cv::Size(coded_size.height, coded_size.width);
}

cv::Mat VideoReader::State::grey_of_image(std::optional<Field> field, cv::Mat recycled) {
  cv::Mat grey = luma.extract(decoder.image(), rotation ? coded_grey : recycled);
  if (grey.empty()) return {};
  if (field) interpolate_other_field(grey, *field);
  if (!rotation) return grey;
  coded_grey = grey;
  cv::rotate(coded_grey, recycled, *rotation);
  return recycled;
}

ReadResult VideoReader::read(cv::Mat recycled) {
  State& s = *state_;
  while (true) {
    const ReadResult::Status status = s.decoder.next();
    if (status != ReadResult::Status::frame) {
      // an undecodable image takes its interval
      if (status == ReadResult::Status::undecodable && s.images > 0) ++s.images;
      return {.status = status};
    }
    const Timestamp stamp = s.stamp_of_image();
    ++s.images;
    s.last = stamp;
    if (stamp < s.start) continue;
    const AVFrame& image = s.decoder.image();
    if (image.decode_error_flags != 0 || (image.flags & AV_FRAME_FLAG_CORRUPT) != 0) {
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
    const std::optional<Field> field =
        first_field(image, s.decoder.track().stream->codecpar->field_order);
    cv::Mat grey = s.grey_of_image(field, std::move(recycled));
    if (grey.empty()) return {.status = ReadResult::Status::undecodable};
    return {.status = ReadResult::Status::frame,
            .frame = {.stamp = stamp, .grey = std::move(grey)},
            .interlaced = field.has_value()};
  }
}

bool VideoReader::is_rotated() const {
  return state_->rotation.has_value();
}

double VideoReader::stamp_resolution_s() const {
  constexpr double kRounding = 1e-6;
  if (state_->rate_hz) return 0;
  const double step_s = av_q2d(state_->decoder.track().stream->time_base);
  const std::optional<double> rate_hz = frames_per_s();
  if (!rate_hz) return step_s;
  const double steps = 1 / (*rate_hz * step_s);
  if (steps < 2) return 0;  // counts frames; the mean rate is lower if some are missing
  return std::abs(steps - std::round(steps)) < kRounding * steps ? 0 : step_s;
}

std::vector<std::string> VideoReader::notes() const {
  const State& s = *state_;
  std::vector<std::string> notes;
  const std::optional<std::string> choice = track_choice(s.decoder.track());
  if (choice && !s.config.track) notes.push_back(s.name + ": " + *choice);
  if (s.rate_hz && !s.config.rate_hz) {
    notes.push_back(fmt::format(
        "{}: no time stamps; the frame rate of {:.6g} Hz is that of the stream's headers, "
        "source.rate_hz replaces it",
        s.name, *s.rate_hz));
  }
  constexpr double kRounding = 0.01;
  const VideoTrack& track = s.decoder.track();
  const AVRational aspect =
      av_guess_sample_aspect_ratio(track.container.get(), track.stream, nullptr);
  if (aspect.num > 0 && aspect.den > 0 && std::abs(av_q2d(aspect) - 1) >= kRounding) {
    notes.push_back(fmt::format(
        "{}: non-square pixels, aspect ratio {}:{}; images are not rescaled, the calibration must "
        "be of the coded images",
        s.name, aspect.num, aspect.den));
  }
  return notes;
}

std::optional<double> VideoReader::duration_s() const {
  const VideoTrack& track = state_->decoder.track();
  if (track.stream->duration != AV_NOPTS_VALUE) {
    return static_cast<double>(track.stream->duration) * av_q2d(track.stream->time_base);
  }
  // the container's duration may be that of an audio stream
  if (track.container->nb_streams > 1 || track.container->duration == AV_NOPTS_VALUE) {
    return std::nullopt;
  }
  return static_cast<double>(track.container->duration) / AV_TIME_BASE;
}

std::optional<double> VideoReader::frames_per_s() const {
  if (state_->rate_hz) return state_->rate_hz;
  const AVRational rate = state_->decoder.track().stream->avg_frame_rate;
  if (rate.num <= 0 || rate.den <= 0) return std::nullopt;
  return av_q2d(rate);
}

std::optional<std::string> VideoReader::truncation() const {
  const State& s = *state_;
  const std::optional<double> duration = duration_s();
  const std::optional<double> rate = frames_per_s();
  if (!s.decoder.read_all() || s.rate_hz || !duration || !rate) return std::nullopt;
  const double end_s = to_seconds(s.last) + 1.0 / *rate;
  // tolerance of 3 frames for rounding and variable frame rate
  if (end_s + 3.0 / *rate >= *duration) return std::nullopt;
  return fmt::format("{}: truncated file: images end at {:.2f} s of {:.2f} s", s.name, end_s,
                     *duration);
}

}  // namespace stillkite
