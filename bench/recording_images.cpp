#include "recording_images.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite::bench {
namespace {

Recording with_images(const Recording& recording,
                      const std::function<cv::Mat(const RecordedImage&)>& change) {
  Recording out = recording;
  for (RecordedImage& image : out.images) image.grey = change(image);
  return out;
}

}  // namespace

Recording half_size(const Recording& recording) {
  Recording out = with_images(recording, [](const RecordedImage& image) {
    const cv::Size half(image.grey.cols / 2, image.grey.rows / 2);
    cv::Mat grey;
    cv::resize(image.grey(cv::Rect({}, half * 2)), grey, half, 0, 0, cv::INTER_AREA);
    return grey;
  });
  out.camera = half_resolution(recording.camera);
  return out;
}

Recording with_gamma(const Recording& recording, double gamma) {
  constexpr double kWhite = 255;
  cv::Mat table(1, 256, CV_8UC1);
  for (int grey = 0; grey < table.cols; ++grey) {
    table.at<std::uint8_t>(grey) =
        cv::saturate_cast<std::uint8_t>(kWhite * std::pow(grey / kWhite, gamma));
  }
  return with_images(recording, [&](const RecordedImage& image) {
    cv::Mat grey;
    cv::LUT(image.grey, table, grey);
    return grey;
  });
}

Recording with_noise(const Recording& recording, double sigma_grey, std::uint64_t seed) {
  cv::RNG random(seed);
  return with_images(recording, [&](const RecordedImage& image) {
    cv::Mat noise(image.grey.size(), CV_32FC1);
    random.fill(noise, cv::RNG::NORMAL, 0, sigma_grey);
    cv::Mat grey;
    cv::add(image.grey, noise, grey, cv::noArray(), CV_8UC1);
    return grey;
  });
}

Recording with_jpeg(const Recording& recording, int quality) {
  return with_images(recording, [quality](const RecordedImage& image) {
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", image.grey, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  });
}

Recording with_exposure_steps(const Recording& recording, double low_gain) {
  const Timestamp first = recording.images.front().stamp;
  const double duration_s = seconds_between(first, recording.images.back().stamp);
  const double step_s = std::min(1.0, duration_s / 6);
  return with_images(recording, [=](const RecordedImage& image) {
    const auto step = static_cast<int>(seconds_between(first, image.stamp) / step_s);
    cv::Mat grey;
    image.grey.convertTo(grey, CV_8UC1, step % 2 == 0 ? 1.0 : low_gain);
    return grey;
  });
}

}  // namespace stillkite::bench
