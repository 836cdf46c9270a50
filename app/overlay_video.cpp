#include "app/overlay_video.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

namespace stillkite {

OverlayVideo::OverlayVideo(std::filesystem::path file, const Camera& camera,
                           const RigidTransform& body_from_camera)
    : file_(std::move(file)), overlay_(camera, body_from_camera) {}

void OverlayVideo::open(double frames_per_s) {
  constexpr double kMinFrameRate = 0.1;
  constexpr double kMaxFrameRate = 1000;
  writer_.emplace(file_, overlay_.size(), std::clamp(frames_per_s, kMinFrameRate, kMaxFrameRate),
                  EncoderConfig{.preset = EncoderPreset::veryfast});
  writer_->write(first_);
}

void OverlayVideo::add(const Frame& frame, const NavigationEstimate& estimate,
                       std::span<const WeightedFlow> flow_vectors) {
  const cv::Mat& image = overlay_.draw(frame.grey, estimate, flow_vectors);
  if (first_.empty()) {
    first_ = image.clone();
    first_stamp_ = frame.stamp;
    return;
  }
  if (!writer_) open(1 / seconds_between(first_stamp_, frame.stamp));
  writer_->write(image);
}

void OverlayVideo::finish() {
  if (first_.empty()) return;
  if (!writer_) open(1);
  writer_->finish();
}

void OverlayVideo::commit() {
  finish();
  if (writer_) writer_->commit();
}

}  // namespace stillkite
