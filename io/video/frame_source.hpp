#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "flow/frame.hpp"
#include "io/config/source_config.hpp"

namespace stillkite {

/// Frames of a video, data set or folder, decoded ahead on a separate thread. Memory is bounded if
/// the caller releases the frames.
class FrameSource {
 public:
  /// Throws InputError if the source is missing or no image can be decoded.
  explicit FrameSource(const SourceConfig& config);
  ~FrameSource();
  FrameSource(FrameSource&&) noexcept;
  FrameSource& operator=(FrameSource&&) noexcept;

  /// First frame; next() returns it, too.
  [[nodiscard]] const Frame& first() const;

  /// Next frame, stamps ascending and without their jitter (StampFilter); nullopt at the end.
  /// Undecodable images and stamps that do not increase are skipped and counted. Throws InputError
  /// if the image size changes.
  [[nodiscard]] std::optional<Frame> next();

  /// Images read so far: returned and skipped.
  [[nodiscard]] std::int64_t read() const;
  [[nodiscard]] std::int64_t rejected() const;

  /// Time of decoding so far, on its own thread.
  [[nodiscard]] double decoding_s() const;

  /// Expected number of frames, for progress; nullopt if unknown.
  [[nodiscard]] std::optional<std::int64_t> expected() const;

  /// True if image rows are not sensor rows; see VideoReader::is_rotated.
  [[nodiscard]] bool is_rotated() const;

  /// Problems of the source so far: non-square pixels, skipped images and, after the end,
  /// truncation. Nullopt without any.
  [[nodiscard]] std::optional<std::string> problem() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
