#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace stillkite {

struct CloseInput {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
template <typename T>
using LibavInput = std::unique_ptr<T, CloseInput>;

/// One video track of an open file.
struct VideoTrack {
  LibavInput<AVFormatContext> container;  ///< discards the packets of other tracks
  AVStream* stream = nullptr;             ///< owned by the container
  LibavInput<AVCodecContext> decoder;
};

/// Opens a video track: number `track`, counted from 0 over the video tracks without still images,
/// or the one that libavformat ranks first. Throws InputError if the file cannot be read, if the
/// track is missing, or if there is no decoder for it.
[[nodiscard]] VideoTrack open_video_track(const std::string& file, std::optional<int> track);

/// Message on which of several video tracks is open; nullopt if there is only one.
[[nodiscard]] std::optional<std::string> track_choice(const VideoTrack& track);

/// Rotation by the track's display matrix; errors as display_rotation.
[[nodiscard]] std::optional<cv::RotateFlags> stored_rotation(const VideoTrack& track,
                                                             const std::string& file);

/// True if the file format stores no time stamps, so that libavformat invents a frame rate.
[[nodiscard]] bool has_no_time_stamps(const VideoTrack& track);

/// Frame rate in the headers of the coded video, known once an image is decoded; nullopt if there
/// is none.
[[nodiscard]] std::optional<double> coded_rate_hz(const VideoTrack& track);

}  // namespace stillkite
