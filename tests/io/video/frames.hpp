#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "io/video/frame_source.hpp"

// Numbered test images, and the frames of a source.

namespace stillkite {

// Grey level encodes the frame index, to check order and content after compression.
inline cv::Mat image(int index, cv::Size size = {160, 96}) {
  return cv::Mat(size, CV_8UC1, cv::Scalar(40 + 2 * index));
}

inline std::vector<Frame> read_all(FrameSource& source) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source.next()) frames.push_back(*frame);
  return frames;
}

// Grey level in the uniform half of the image.
inline double brightness(const Frame& frame) {
  return frame.grey.at<unsigned char>(frame.grey.rows * 3 / 4, frame.grey.cols / 2);
}

}  // namespace stillkite
