#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "flow/frame.hpp"
#include "io/config/source_config.hpp"

namespace stillkite {

/// Frames of a video, a data set or a folder, decoded ahead on a thread of its own. Memory does not
/// grow with the number of frames as long as the user lets go of them.
class FrameSource {
 public:
  /// Throws InputError if there is nothing to read, or not one image that can be decoded.
  explicit FrameSource(const SourceConfig& config);
  ~FrameSource();
  FrameSource(FrameSource&&) noexcept;
  FrameSource& operator=(FrameSource&&) noexcept;

  /// The first frame, which next() will give too.
  [[nodiscard]] const Frame& first() const;

  /// Frames in the order of their stamps. What cannot be decoded, and what does not come later than
  /// the frame before, is skipped and counted. Nothing at the end. Throws InputError where the
  /// source breaks its promises half way, such as another image size.
  [[nodiscard]] std::optional<Frame> next();

  /// Images so far: handed out and skipped.
  [[nodiscard]] std::int64_t read() const;
  [[nodiscard]] std::int64_t rejected() const;

  /// What decoding has taken so far, beside whatever was done with the frames.
  [[nodiscard]] double decoding_s() const;

  /// How many there should be in all, for progress.
  [[nodiscard]] std::optional<std::int64_t> expected() const;

  /// The images' rows are not the sensor's, see VideoReader::is_turned.
  [[nodiscard]] bool is_turned() const;

  /// What was wrong with the source so far, if anything: pixels that are told not to be square,
  /// images that were skipped and, after the end, a truncated file.
  [[nodiscard]] std::optional<std::string> complaint() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
