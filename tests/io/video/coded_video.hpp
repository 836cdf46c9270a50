#pragma once

extern "C" {
#include <libavutil/pixfmt.h>
}

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

struct AVFrame;

namespace stillkite {

/// Video of a test, encoded by libavcodec. The container follows from the file's extension.
struct CodedVideo {
  std::string codec;      ///< encoder of libavcodec
  std::string options{};  ///< "key=value;key=value" of the encoder
  AVPixelFormat format = AV_PIX_FMT_YUV420P;
  int rate_hz = 30;
  int frames = 1;
  int width_px = 64;
  int height_px = 48;
  bool full_range = false;
  bool interlaced = false;
  bool top_field_first = true;
  /// Sets the planes of image i; chroma is neutral before.
  std::function<void(AVFrame&, int)> paint;
};

std::filesystem::path write_coded_video(const std::filesystem::path& file, const CodedVideo& video);

/// Copies the video tracks of several files into one.
std::filesystem::path join_tracks(const std::filesystem::path& file,
                                  const std::vector<std::filesystem::path>& tracks);

}  // namespace stillkite
