#include "io/import/video_telemetry.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "io/import/byte_source.hpp"
#include "io/import/dji_subtitles.hpp"
#include "io/import/gopro_telemetry.hpp"
#include "io/video/video_track.hpp"

namespace stillkite {
namespace {

constexpr AVRational kNanoseconds{1, 1'000'000'000};

AVStream* find_gopro_track(const AVFormatContext& container) {
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    if (container.streams[i]->codecpar->codec_tag == MKTAG('g', 'p', 'm', 'd')) {
      return container.streams[i];
    }
  }
  return nullptr;
}

AVStream* find_subtitles(const AVFormatContext& container) {
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    if (container.streams[i]->codecpar->codec_type == AVMEDIA_TYPE_SUBTITLE) {
      return container.streams[i];
    }
  }
  return nullptr;
}

// Time of a track within +-30 years, so that sums of damaged times do not overflow.
std::int64_t nanoseconds(std::int64_t time, const AVStream& track) {
  constexpr std::int64_t kMax_ns = 1'000'000'000'000'000'000;
  return std::clamp(av_rescale_q(time, track.time_base, kNanoseconds), -kMax_ns, kMax_ns);
}

// Calls take(payload, start, end) for each packet of a track; times count from the first image.
template <typename Take>
void read_track(const VideoTrack& video, AVStream& track, Take take) {
  for (unsigned i = 0; i < video.container->nb_streams; ++i) {
    video.container->streams[i]->discard = AVDISCARD_ALL;
  }
  track.discard = AVDISCARD_DEFAULT;
  const AVStream& images = *video.stream;
  const std::int64_t first_ns =
      images.start_time == AV_NOPTS_VALUE ? 0 : nanoseconds(images.start_time, images);
  const LibavInput<AVPacket> packet(av_packet_alloc());
  while (av_read_frame(video.container.get(), packet.get()) >= 0) {
    if (packet->stream_index == track.index && packet->pts != AV_NOPTS_VALUE && packet->size > 0) {
      const std::int64_t start_ns = nanoseconds(packet->pts, track) - first_ns;
      take(Bytes(packet->data, static_cast<std::size_t>(packet->size)), Timestamp{start_ns},
           Timestamp{start_ns + nanoseconds(packet->duration, track)});
    }
    av_packet_unref(packet.get());
  }
}

// Text of a subtitle packet; that of MP4 begins with its length.
std::string_view subtitle_text(Bytes packet, AVCodecID codec) {
  if (codec == AV_CODEC_ID_MOV_TEXT) {
    const auto length = big_endian<std::uint16_t>(packet, 0);
    packet = packet.size() < 2 ? Bytes() : packet.subspan(2);
    packet = packet.first(std::min<std::size_t>(length, packet.size()));
  }
  return {reinterpret_cast<const char*>(packet.data()), packet.size()};
}

std::optional<ImportedFlight> read_telemetry(const VideoTrack& video) {
  if (AVStream* const track = find_gopro_track(*video.container)) {
    GoproTelemetry telemetry;
    read_track(video, *track, [&](Bytes payload, Timestamp start, Timestamp end) {
      telemetry.add(payload, start, end);
    });
    return telemetry.finish();
  }
  if (AVStream* const track = find_subtitles(*video.container)) {
    DjiSubtitles subtitles;
    read_track(video, *track, [&](Bytes packet, Timestamp start, Timestamp) {
      subtitles.add(start, subtitle_text(packet, track->codecpar->codec_id));
    });
    ImportedFlight flight = subtitles.finish();
    flight.found("telemetry: subtitles of the video");
    return flight;
  }
  return std::nullopt;
}

}  // namespace

ImportedVideo read_imported_video(const std::filesystem::path& file, bool with_telemetry) {
  const VideoTrack video = open_video_track(file.string(), std::nullopt);
  ImportedVideo out{.file = file,
                    .width_px = video.stream->codecpar->width,
                    .height_px = video.stream->codecpar->height};
  const std::optional<cv::RotateFlags> rotation = stored_rotation(video, file.string());
  if (rotation && *rotation != cv::ROTATE_180) std::swap(out.width_px, out.height_px);
  if (video.container->duration > 0) {
    out.duration_s = static_cast<double>(video.container->duration) / AV_TIME_BASE;
  }
  if (!with_telemetry) return out;
  try {
    out.telemetry = read_telemetry(video);
  } catch (const InputError& error) {
    out.telemetry.emplace();
    out.telemetry->missing(std::string("telemetry of the video: ") + error.what());
  }
  if (rotation && out.telemetry) {
    out.telemetry->assumed(
        "axes: the video states a rotation of its images; imu, attitude and mount are not rotated");
  }
  return out;
}

}  // namespace stillkite
