#include "app/page_image_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

constexpr int kMaxPageImage_px = 800;

cv::Mat shrunk(const cv::Mat& image) {
  const double scale = static_cast<double>(kMaxPageImage_px) / std::max(image.cols, image.rows);
  if (scale >= 1) return image;
  cv::Mat out;
  cv::resize(image, out, {}, scale, scale, cv::INTER_AREA);
  return out;
}

}  // namespace

std::vector<std::uint8_t> PageImageEncoder::draw(const PageSnapshot& snapshot) {
  constexpr int kQuality = 70;
  if (!overlay_) {
    overlay_.emplace(snapshot.camera, snapshot.body_from_camera, OverlayText::none);
  }
  const cv::Mat& drawn =
      overlay_->draw(snapshot.grey, snapshot.step.estimate, snapshot.flow_vectors);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", shrunk(drawn), jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return jpeg;
}

std::optional<PageImage> PageImageEncoder::encode(const PageSnapshot& snapshot, std::int64_t after,
                                                  Timestamp now) {
  constexpr double kMinInterval_s = 0.1;
  const std::lock_guard lock(mutex_);
  const std::int64_t number = snapshot.number;
  if (number > last_.number && seconds_between(coded_, now) >= kMinInterval_s) {
    last_ = {.number = number,
             .jpeg = std::make_shared<const std::vector<std::uint8_t>>(draw(snapshot))};
    coded_ = now;
  }
  if (!last_.jpeg || last_.number <= after) return std::nullopt;
  return last_;
}

}  // namespace stillkite
