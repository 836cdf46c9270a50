#include "io/video/luma.hpp"

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <array>
#include <bit>
#include <opencv2/core.hpp>
#include <utility>

namespace stillkite {
namespace {

bool has_luma(const AVPixFmtDescriptor& format) {
  constexpr std::uint64_t kOther = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL |
                                   AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL |
                                   AV_PIX_FMT_FLAG_FLOAT;
  return (format.flags & kOther) == 0 && format.comp[0].depth >= 8 && format.comp[0].depth <= 16;
}

bool is_native_endian(const AVPixFmtDescriptor& format) {
  return ((format.flags & AV_PIX_FMT_FLAG_BE) != 0) == (std::endian::native == std::endian::big);
}

}  // namespace

LumaExtractor::LumaExtractor(std::string name, std::optional<int> bits)
    : name_(std::move(name)), depth_(bits) {}
LumaExtractor::~LumaExtractor() = default;
LumaExtractor::LumaExtractor(LumaExtractor&&) noexcept = default;
LumaExtractor& LumaExtractor::operator=(LumaExtractor&&) noexcept = default;

void LumaExtractor::Free::operator()(SwsContext* context) const {
  sws_freeContext(context);
}

cv::Mat LumaExtractor::extract(const AVFrame& frame, cv::Mat recycled) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  if (format == nullptr) return {};
  const AVComponentDescriptor& luma = format->comp[0];
  if (luma.depth <= 8) depth_.check_8_bits(name_);
  if (!has_luma(*format)) return convert_rgb(frame, luma.depth, std::move(recycled));
  std::uint8_t* plane = frame.data[luma.plane];
  const int step = frame.linesize[luma.plane];
  if (luma.depth == 8 && luma.step == 1 && luma.offset == 0) {
    recycled.create(frame.height, frame.width, CV_8UC1);
    av_image_copy_plane(recycled.data, static_cast<int>(recycled.step[0]), plane, step, frame.width,
                        frame.height);
    return recycled;
  }
  if (luma.depth > 8 && luma.step == 2 && luma.offset == 0 && step > 0 &&
      is_native_endian(*format)) {
    const cv::Mat samples(frame.height, frame.width, CV_16UC1, plane,
                          static_cast<std::size_t>(step));
    return depth_.to_8_bits(samples, {luma.depth, luma.shift}, name_, std::move(recycled));
  }
  samples_.create(frame.height, frame.width, CV_16UC1);
  const std::array<const std::uint8_t*, 4> planes{frame.data[0], frame.data[1], frame.data[2],
                                                  frame.data[3]};
  for (int row = 0; row < frame.height; ++row) {
    av_read_image_line2(samples_.ptr(row), const_cast<const std::uint8_t**>(planes.data()),
                        frame.linesize, format, 0, row, 0, frame.width, 0, sizeof(std::uint16_t));
  }
  if (luma.depth > 8)
    return depth_.to_8_bits(samples_, {luma.depth, 0}, name_, std::move(recycled));
  samples_.convertTo(recycled, CV_8U);
  return recycled;
}

cv::Mat LumaExtractor::convert_rgb(const AVFrame& frame, int depth, cv::Mat recycled) {
  const bool is_deep = depth > 8 && depth <= 16;
  cv::Mat& grey = is_deep ? samples_ : recycled;
  grey.create(frame.height, frame.width, is_deep ? CV_16UC1 : CV_8UC1);
  converter_.reset(sws_getCachedContext(
      converter_.release(), frame.width, frame.height, static_cast<AVPixelFormat>(frame.format),
      frame.width, frame.height, is_deep ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8, SWS_POINT, nullptr,
      nullptr, nullptr));
  if (!converter_) return {};
  const std::array<std::uint8_t*, 4> planes{grey.data};
  const std::array<int, 4> steps{static_cast<int>(grey.step[0])};
  sws_scale(converter_.get(), frame.data, frame.linesize, 0, frame.height, planes.data(),
            steps.data());
  if (!is_deep) return recycled;
  return depth_.to_8_bits(samples_, {depth, 16 - depth}, name_, std::move(recycled));
}

}  // namespace stillkite
