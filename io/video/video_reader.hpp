#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "io/video/read_result.hpp"

namespace stillkite {

/// Decodes a video file with libavformat and libavcodec, the libraries behind OpenCV's own reader,
/// because that one can only hand out BGR. The luma plane is taken as it is, video range (16 to
/// 235) is not stretched. Images are turned by the file's rotation mark, as in OpenCV's reader
/// and every player, for calibrations are made from such images; pixels that the file calls
/// oblong stay as they are coded, for the same reason. Formats without a luma plane of 8 bits are
/// converted to grey.
class VideoReader {
 public:
  /// Stamps come from the file (0 is its first image) or, with a rate, from counting images.
  /// Images before `start_s` are skipped. Throws InputError if there is no video to decode, or
  /// one that is to be shown mirrored or turned by anything but quarters.
  VideoReader(const std::filesystem::path& file, double start_s, std::optional<double> rate_hz);
  ~VideoReader();
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;

  /// The next image, in `recycled` if that has its size. Throws InputError if the video's
  /// images change their size.
  [[nodiscard]] ReadResult read(cv::Mat recycled);

  /// By the file's mark: a row of the image is then another, or a column, of the sensor's.
  [[nodiscard]] bool is_turned() const;

  /// Says so where the file calls its pixels oblong.
  [[nodiscard]] std::optional<std::string> oblong_pixels() const;

  /// Seconds from the first image to the end as the file's header says.
  [[nodiscard]] std::optional<double> duration_s() const;
  [[nodiscard]] std::optional<double> frames_per_s() const;

  /// After the end: says that the file ended before its header's duration.
  [[nodiscard]] std::optional<std::string> truncation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
