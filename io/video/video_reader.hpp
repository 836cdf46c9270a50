#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "io/config/source_config.hpp"
#include "io/video/read_result.hpp"

namespace stillkite {

/// Decodes a video file with libavformat and libavcodec; OpenCV's reader returns BGR only.
/// - Grey values: LumaExtractor.
/// - Images are rotated by the display matrix, but non-square pixels are not rescaled. OpenCV's
///   reader does the same, and calibrations are made from its images.
/// - Of interlaced images the first field is used, and its lines are interpolated.
class VideoReader {
 public:
  /// Stamps are those of the file, relative to its first image, or image number / rate_hz. Images
  /// before `start_s` are skipped. Throws InputError if there is no decodable video, if a bare
  /// stream has no frame rate, or if the display matrix mirrors or does not rotate by a multiple of
  /// 90 deg.
  explicit VideoReader(const SourceConfig& config);
  ~VideoReader();
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;

  /// Next image, stored in `recycled` if the size matches. Throws InputError if the image size
  /// changes, or as LumaExtractor.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  /// True if the display matrix rotates the images, so that image rows are not sensor rows.
  [[nodiscard]] bool is_rotated() const;

  /// Step to which the file rounds the stamps; 0 if the frame interval is a multiple of it.
  [[nodiscard]] double stamp_resolution_s() const;

  /// Messages on the choice of the track, on an assumed frame rate and on pixels that are not
  /// square; empty without any.
  [[nodiscard]] std::vector<std::string> notes() const;

  /// Duration in the file's header; nullopt if unknown.
  [[nodiscard]] std::optional<double> duration_s() const;
  [[nodiscard]] std::optional<double> frames_per_s() const;

  /// Message after the end if the file is shorter than its header's duration; nullopt otherwise.
  [[nodiscard]] std::optional<std::string> truncation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
