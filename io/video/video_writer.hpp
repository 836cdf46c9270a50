#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// Speed presets of x264; slower ones compress better.
enum class EncoderPreset { ultrafast, veryfast, fast, medium, slow };

template <>
struct EnumNames<EncoderPreset> {
  static constexpr auto value = std::to_array<std::pair<EncoderPreset, std::string_view>>(
      {{EncoderPreset::ultrafast, "ultrafast"},
       {EncoderPreset::veryfast, "veryfast"},
       {EncoderPreset::fast, "fast"},
       {EncoderPreset::medium, "medium"},
       {EncoderPreset::slow, "slow"}});
};

struct EncoderConfig {
  int crf = 23;
  EncoderPreset preset = EncoderPreset::medium;

  static void fields(auto& self, auto&& field) {
    field("crf", self.crf, Range{0, 51}, "constant rate factor of x264; 0 is lossless");
    field("preset", self.preset, "speed preset of x264");
  }
};

/// H.264 encoder. Grey images are the luma plane unchanged (full range) with neutral chroma;
/// colours are converted to full-range BT.601. The file appears complete or not at all, as an
/// OutputFile. Deterministic: equal images give equal files.
class VideoWriter {
 public:
  /// Width and height must be even. Throws InputError if they are odd, if the file cannot be
  /// created, or without an H.264 encoder.
  VideoWriter(const std::filesystem::path& file, cv::Size size, double frames_per_s,
              const EncoderConfig& config);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Writes a frame of the writer's size, CV_8UC1 (grey) or CV_8UC3 (BGR). Throws
  /// std::runtime_error on a write error.
  void write(const cv::Mat& image);
  /// Flushes everything to disk; commit() then only renames.
  void finish();
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
