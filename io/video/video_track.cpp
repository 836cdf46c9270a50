#include "io/video/video_track.hpp"

extern "C" {
#include <libavutil/opt.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "geometry/fields.hpp"
#include "io/recording_format.hpp"
#include "io/video/display_rotation.hpp"

namespace stillkite {
namespace {

LibavInput<AVFormatContext> open_container(const std::string& file) {
  AVDictionary* options = nullptr;
  // no network access by play lists
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  AVFormatContext* context = nullptr;
  const int error = avformat_open_input(&context, file.c_str(), nullptr, &options);
  av_dict_free(&options);
  if (error < 0) {
    if (recording_format_of(file) != RecordingFormat::mp4) reject_recording(file);
    throw InputError(file +
                     ": not a video file, or its header or index is missing (interrupted recording "
                     "or download)");
  }
  LibavInput<AVFormatContext> container(context);
  if (avformat_find_stream_info(context, nullptr) < 0) {
    throw InputError(file + ": cannot read the streams; the file is damaged");
  }
  return container;
}

LibavInput<AVCodecContext> open_decoder(const AVStream& stream, const std::string& file) {
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  LibavInput<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  decoder->thread_count = 0;  // one per core
  if (codec == nullptr || avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0) {
    throw InputError(fmt::format("{}: no decoder for {} video", file,
                                 avcodec_get_name(stream.codecpar->codec_id)));
  }
  decoder->framerate = {0, 1};  // may be the demuxer's
  if (avcodec_open2(decoder.get(), codec, nullptr) < 0) {
    throw InputError(fmt::format("{}: the {} decoder does not support this video", file,
                                 avcodec_get_name(stream.codecpar->codec_id)));
  }
  return decoder;
}

// Indices of the video streams without cover art and thumbnails.
std::vector<int> video_streams(const AVFormatContext& container) {
  constexpr int kStill = AV_DISPOSITION_ATTACHED_PIC | AV_DISPOSITION_TIMED_THUMBNAILS;
  std::vector<int> indices;
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    const AVStream& stream = *container.streams[i];
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && (stream.disposition & kStill) == 0) {
      indices.push_back(static_cast<int>(i));
    }
  }
  return indices;
}

std::string list_tracks(const AVFormatContext& container, const std::vector<int>& streams) {
  std::string out;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const AVCodecParameters& coded = *container.streams[streams[i]]->codecpar;
    out += fmt::format("{}{} ({} {}x{})", i == 0 ? "" : ", ", i, avcodec_get_name(coded.codec_id),
                       coded.width, coded.height);
  }
  return out;
}

int select_stream(AVFormatContext& container, const std::string& file, std::optional<int> track) {
  const std::vector<int> streams = video_streams(container);
  if (track) {
    const auto at = static_cast<std::size_t>(*track);
    if (at < streams.size()) return streams[at];
    throw InputError(fmt::format("{}: source.track: {} is out of range, video tracks: {}", file,
                                 *track, list_tracks(container, streams)));
  }
  const AVCodec* codec = nullptr;  // demands a track with a decoder
  const int best = av_find_best_stream(&container, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  if (best < 0) throw InputError(file + ": no video stream that can be decoded");
  return best;
}

}  // namespace

VideoTrack open_video_track(const std::string& file, std::optional<int> track) {
  VideoTrack opened{.container = open_container(file)};
  const int index = select_stream(*opened.container, file, track);
  opened.stream = opened.container->streams[index];
  opened.decoder = open_decoder(*opened.stream, file);
  for (unsigned i = 0; i < opened.container->nb_streams; ++i) {
    if (static_cast<int>(i) != index) opened.container->streams[i]->discard = AVDISCARD_ALL;
  }
  return opened;
}

std::optional<std::string> track_choice(const VideoTrack& track) {
  const std::vector<int> streams = video_streams(*track.container);
  if (streams.size() < 2) return std::nullopt;
  const auto at = std::find(streams.begin(), streams.end(), track.stream->index);
  return fmt::format("video track {} is read; source.track selects another: {}",
                     at - streams.begin(), list_tracks(*track.container, streams));
}

std::optional<cv::RotateFlags> stored_rotation(const VideoTrack& track, const std::string& file) {
  std::array<std::int32_t, 9> matrix{};
  std::size_t bytes = 0;
  const std::uint8_t* mark =
      av_stream_get_side_data(track.stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
  if (mark == nullptr || bytes < sizeof(matrix)) return std::nullopt;
  std::memcpy(matrix.data(), mark, sizeof(matrix));
  return display_rotation(matrix, file);
}

bool has_no_time_stamps(const VideoTrack& track) {
  // demuxers of bare streams and of single images have the option -framerate, 25 by default
  const AVClass* options = track.container->iformat->priv_class;
  return options != nullptr &&
         av_opt_find(&options, "framerate", nullptr, 0, AV_OPT_SEARCH_FAKE_OBJ) != nullptr;
}

std::optional<double> coded_rate_hz(const VideoTrack& track) {
  switch (track.decoder->codec_id) {  // framerate of other codecs is a tick rate, or assumed
    case AV_CODEC_ID_H264:
    case AV_CODEC_ID_HEVC:
    case AV_CODEC_ID_MPEG1VIDEO:
    case AV_CODEC_ID_MPEG2VIDEO:
      break;
    default:
      return std::nullopt;
  }
  constexpr double kMin_hz = 1, kMax_hz = 1000;  // else ticks of a variable rate
  const AVRational rate = track.decoder->framerate;
  if (rate.num <= 0 || rate.den <= 0) return std::nullopt;
  const double rate_hz = av_q2d(rate);
  return rate_hz >= kMin_hz && rate_hz <= kMax_hz ? std::optional(rate_hz) : std::nullopt;
}

}  // namespace stillkite
