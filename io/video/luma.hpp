#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

struct AVFrame;
struct SwsContext;

namespace stillkite {

/// Extracts the grey image of a decoded frame.
class LumaExtractor {
 public:
  LumaExtractor();
  ~LumaExtractor();
  LumaExtractor(LumaExtractor&&) noexcept;
  LumaExtractor& operator=(LumaExtractor&&) noexcept;

  /// CV_8UC1 image of the frame's size, stored in `recycled` if it fits. Empty if the pixel format
  /// cannot be converted.
  [[nodiscard]] cv::Mat extract(const AVFrame& frame, cv::Mat recycled);

 private:
  struct Free {
    void operator()(SwsContext* context) const;
  };
  std::unique_ptr<SwsContext, Free> converter_;
};

}  // namespace stillkite
