#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "io/video/grey_depth.hpp"

struct AVFrame;
struct SwsContext;

namespace stillkite {

/// Extracts the 8-bit grey image of a decoded frame. Luma keeps its range: video range (16 to 235
/// of 255) is not stretched. Luma of more than 8 bits is reduced by GreyDepth; RGB is converted.
class LumaExtractor {
 public:
  /// `name` of the video, for errors; `bits` as GreyDepth.
  LumaExtractor(std::string name, std::optional<int> bits);
  ~LumaExtractor();
  LumaExtractor(LumaExtractor&&) noexcept;
  LumaExtractor& operator=(LumaExtractor&&) noexcept;

  /// CV_8UC1 image of the frame's size, stored in `recycled` if it fits. Empty if the pixel format
  /// cannot be converted. Throws InputError as GreyDepth.
  [[nodiscard]] cv::Mat extract(const AVFrame& frame, cv::Mat recycled);

 private:
  [[nodiscard]] cv::Mat convert_rgb(const AVFrame& frame, int depth, cv::Mat recycled);

  struct Free {
    void operator()(SwsContext* context) const;
  };
  std::string name_;
  GreyDepth depth_;
  cv::Mat samples_;  // 16-bit grey
  std::unique_ptr<SwsContext, Free> converter_;
};

}  // namespace stillkite
