#include "io/video/image_sequence.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "geometry/fields.hpp"
#include "io/video/exif_orientation.hpp"

namespace stillkite {
namespace {

bool load(const std::filesystem::path& file, std::vector<unsigned char>& bytes) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  if (!stream || size <= 0) return false;
  bytes.resize(static_cast<std::size_t>(size));
  stream.seekg(0);
  return static_cast<bool>(stream.read(reinterpret_cast<char*>(bytes.data()), size));
}

// Of a TIFF file with several pages only the first would be read.
void reject_pages(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".tif" && extension != ".tiff") return;
  const std::size_t pages = cv::imcount(file.string(), cv::IMREAD_GRAYSCALE);
  if (pages < 2) return;
  throw InputError(
      fmt::format("{}: {} pages; split the file into images of one page", file.string(), pages));
}

}  // namespace

void ImageSequence::check_format(const StampedImage& image, cv::Size size, int orientation) {
  if (size_.area() > 0 && size != size_) {
    throw InputError(fmt::format(
        "{}: image size {}x{} differs from {}x{} before; one calibration needs one size",
        image.file.string(), size.width, size.height, size_.width, size_.height));
  }
  if (orientation_ && orientation != *orientation_) {
    throw InputError(fmt::format(
        "{}: EXIF orientation {} differs from {} before; remove the tag from the files, "
        "so that all images are used as stored",
        image.file.string(), orientation, *orientation_));
  }
  reject_mirrored(orientation, image.file.string());
  size_ = size;
  if (!orientation_) orientation_ = orientation;
}

ReadResult ImageSequence::read(cv::Mat recycled) {
  if (at_ == images_.size()) return {};
  const StampedImage& image = images_[at_++];
  const bool is_loaded = load(image.file, bytes_);
  const int orientation = is_loaded ? exif_orientation(bytes_) : 1;
  const bool rotates = orientation != 1 && !is_tiff(bytes_);  // OpenCV's TIFF decoder rotates
  if (is_loaded && size_.empty()) reject_pages(image.file);
  cv::Mat grey;
  try {
    constexpr int kGrey =
        cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION;
    cv::Mat& target = !deep_.empty() ? deep_ : rotates ? stored_ : recycled;
    if (is_loaded) grey = cv::imdecode(bytes_, kGrey, &target);
  } catch (const cv::Exception&) {
    // invalid image size in the header
    grey.release();
  }
  if (grey.depth() != CV_8U && grey.depth() != CV_16U) grey.release();
  if (grey.empty()) return {.status = ReadResult::Status::undecodable};
  check_format(image, grey.size(), orientation);
  if (grey.depth() == CV_16U) {
    const bool is_first = deep_.empty();
    deep_ = grey;
    cv::Mat target = rotates ? stored_ : recycled;
    grey = depth_.to_8_bits(deep_, {}, image.file.string(), is_first ? cv::Mat() : target);
  } else {
    depth_.check_8_bits(image.file.string());
    deep_.release();  // may share the returned buffer
  }
  if (rotates) {
    stored_ = grey;
    cv::rotate(stored_, recycled, exif_rotation(orientation));
    grey = recycled;
  }
  return {.status = ReadResult::Status::frame, .frame = {.stamp = image.stamp, .grey = grey}};
}

std::vector<Timestamp> ImageSequence::stamps() const {
  std::vector<Timestamp> stamps;
  for (const StampedImage& image : images_) stamps.push_back(image.stamp);
  return stamps;
}

}  // namespace stillkite
