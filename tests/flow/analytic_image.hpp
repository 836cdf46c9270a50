#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core/mat.hpp>

#include "flow/flow_field.hpp"

namespace stillkite {

/// Analytic image at real coordinates: waves of 9 to 60 px in eight directions, grey 128 +- 100.
inline double analytic_grey(const Eigen::Vector2d& p) {
  double grey = 128;
  for (int k = 0; k < 8; ++k) {
    const double wave = 2 * M_PI / (9 * std::pow(60.0 / 9, k / 7.0));
    const Eigen::Vector2d direction(std::cos(2.4 * k), std::sin(2.4 * k));
    grey += 12.5 * std::sin(wave * direction.dot(p) + 1.7 * k * k);
  }
  return grey;
}

/// Rendering of the analytic image after the motion p -> motion * p.
inline cv::Mat analytic_frame(cv::Size size, const Eigen::Affine2d& motion,
                              double brightness_offset = 0) {
  const Eigen::Affine2d inverse_motion = motion.inverse();
  cv::Mat frame(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      frame.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(
          analytic_grey(inverse_motion * Eigen::Vector2d(x, y)) + brightness_offset);
    }
  }
  return frame;
}

struct EndPointError {
  double mean_px = 0;
  double max_px = 0;
};

/// End-point error over all vectors with both end points at least `margin_px` inside the image.
inline EndPointError end_point_error(const FlowField& field, cv::Size size,
                                     const Eigen::Affine2d& motion, int margin_px) {
  const Eigen::AlignedBox2d inside(
      Eigen::Vector2d(margin_px, margin_px),
      Eigen::Vector2d(size.width - 1 - margin_px, size.height - 1 - margin_px));
  EndPointError error;
  int count = 0;
  for (int i = 0; i < field.flow_px.rows; ++i) {
    for (int j = 0; j < field.flow_px.cols; ++j) {
      const int half = field.stride_px / 2;
      const Eigen::Vector2d p(field.stride_px * j + half, field.stride_px * i + half);
      const Eigen::Vector2d target = motion * p;
      if (!inside.contains(p) || !inside.contains(target)) continue;
      const auto flow = field.flow_px.at<cv::Vec2f>(i, j);
      const double error_px = (p + Eigen::Vector2d(flow[0], flow[1]) - target).norm();
      error.mean_px += error_px;
      error.max_px = std::max(error.max_px, error_px);
      ++count;
    }
  }
  error.mean_px /= std::max(count, 1);
  return error;
}

}  // namespace stillkite
