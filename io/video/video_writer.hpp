#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// x264's speed presets: slower ones need fewer bytes for the same image.
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
    field("crf", self.crf, Range{0, 51}, "x264's constant rate factor; 0 is lossless");
    field("preset", self.preset, "x264's effort");
  }
};

/// Writes images as H.264. Greys are the luma plane as they are (full range) and chroma is
/// neutral; colours become BT.601 of full range. The file appears under its name whole or not at
/// all, as an OutputFile does. The same images give the same bytes.
class VideoWriter {
 public:
  /// Width and height must be even. Throws InputError if they are not, if the file cannot be
  /// created, and if the libraries have no H.264 encoder.
  VideoWriter(const std::filesystem::path& file, cv::Size size, double frames_per_s,
              const EncoderConfig& config);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// CV_8UC1, grey, or CV_8UC3, BGR, of the writer's size. Throws std::runtime_error if it cannot
  /// be written.
  void write(const cv::Mat& image);
  /// All of it is on the disk, and only the name is missing.
  void finish();
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
