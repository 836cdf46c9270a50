#include "io/dataset/mask_file.hpp"

#include <fmt/core.h>

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace stillkite {

std::shared_ptr<const ImageMask> read_mask(const CalibrationConfig& config, const cv::Size& size) {
  if (!config.mask_path) return nullptr;
  const std::string name = config.mask_path->string();
  // imread prints a warning of its own for a missing file
  const bool exists = std::filesystem::exists(*config.mask_path);
  const cv::Mat grey = exists ? cv::imread(name, cv::IMREAD_GRAYSCALE) : cv::Mat();
  if (grey.empty()) {
    throw InputError("calibration.mask_path: " + name +
                     " is missing or not an image; give a PNG, black where the scene is hidden");
  }
  if (grey.size() != size) {
    throw InputError(fmt::format("calibration.mask_path: {} is {}x{}, but the images are {}x{}",
                                 name, grey.cols, grey.rows, size.width, size.height));
  }
  constexpr std::uint8_t kMaxBlack = 127;
  auto mask = std::make_shared<const ImageMask>(grey > kMaxBlack);
  if (mask->masked_ratio() == 1) {
    throw InputError("calibration.mask_path: " + name +
                     " is entirely black; paint the visible scene white");
  }
  return mask;
}

}  // namespace stillkite
