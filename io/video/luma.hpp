#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

struct AVFrame;
struct SwsContext;

namespace stillkite {

/// Takes the grey image out of a decoded one.
class LumaExtractor {
 public:
  LumaExtractor();
  ~LumaExtractor();
  LumaExtractor(LumaExtractor&&) noexcept;
  LumaExtractor& operator=(LumaExtractor&&) noexcept;

  /// CV_8UC1 of the frame's size, in `recycled` if that fits. Empty if the pixel format is none
  /// that can be turned to grey.
  [[nodiscard]] cv::Mat extract(const AVFrame& frame, cv::Mat recycled);

 private:
  struct Free {
    void operator()(SwsContext* context) const;
  };
  std::unique_ptr<SwsContext, Free> converter_;
};

}  // namespace stillkite
