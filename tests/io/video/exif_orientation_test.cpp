#include "io/video/exif_orientation.hpp"

#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/video/frame_source.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

std::string number(std::size_t value, int bytes, bool big_endian) {
  std::string out;
  for (int i = 0; i < bytes; ++i) {
    out += static_cast<char>(value >> (8 * (big_endian ? bytes - 1 - i : i)));
  }
  return out;
}

// TIFF header and a directory with the orientation (EXIF 2.32, 4.6).
std::string exif(int orientation, bool big_endian) {
  const auto n = [=](std::size_t value, int bytes) { return number(value, bytes, big_endian); };
  const std::string kept = n(0x0100, 2) + n(3, 2) + n(1, 4) + n(9, 2) + n(0, 2);
  return (big_endian ? "MM" : "II") + n(42, 2) + n(8, 4) + n(2, 2) + kept + n(0x0112, 2) + n(3, 2) +
         n(1, 4) + n(static_cast<std::size_t>(orientation), 2) + n(0, 2) + n(0, 4);
}

std::string encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

std::string jpeg(const cv::Mat& image, int orientation, bool big_endian = true) {
  const std::string data = std::string("Exif\0\0", 6) + exif(orientation, big_endian);
  return encoded(".jpg", image).insert(2, "\xFF\xE1" + number(data.size() + 2, 2, true) + data);
}

std::string png(const cv::Mat& image, int orientation) {
  const std::string data = "eXIf" + exif(orientation, false);
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? 0xEDB88320 ^ (crc >> 1) : crc >> 1;
  }
  constexpr std::size_t kAfterHeader = 8 + 25;
  return encoded(".png", image)
      .insert(kAfterHeader,
              number(data.size() - 4, 4, true) + data + number(~crc & 0xFFFFFFFF, 4, true));
}

// Uncompressed TIFF with the orientation in its directory (TIFF 6.0, section 4).
std::string tiff(const cv::Mat& image, int orientation) {
  const std::size_t size = image.total();
  std::string out = "II" + number(42, 2, false) + number(8 + size, 4, false);
  out.append(reinterpret_cast<const char*>(image.data), size);
  const std::vector<std::array<std::size_t, 2>> entries{
      {256, static_cast<std::size_t>(image.cols)},
      {257, static_cast<std::size_t>(image.rows)},
      {258, 8},
      {259, 1},
      {262, 1},
      {273, 8},
      {274, static_cast<std::size_t>(orientation)},
      {277, 1},
      {278, static_cast<std::size_t>(image.rows)},
      {279, size}};
  out += number(entries.size(), 2, false);
  for (const auto& [tag, value] : entries) {
    out +=
        number(tag, 2, false) + number(4, 2, false) + number(1, 4, false) + number(value, 4, false);
  }
  return out + number(0, 4, false);
}

cv::Mat gradient() {
  cv::Mat image(48, 64, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<unsigned char>(y, x) = static_cast<unsigned char>(x + 3 * y);
    }
  }
  return image;
}

Frame first_frame(const fs::path& folder) {
  return FrameSource({.path = folder, .rate_hz = 1}).first();
}

TEST(ExifOrientation, RotatesImagesAsStoredOnes) {
  const cv::Mat stored = gradient();
  const std::string plain = encoded(".jpg", stored);
  const cv::Mat decoded =
      cv::imdecode(std::vector<char>(plain.begin(), plain.end()), cv::IMREAD_GRAYSCALE);
  for (const auto& [orientation, code] :
       {std::pair{3, cv::ROTATE_180}, std::pair{6, cv::ROTATE_90_CLOCKWISE},
        std::pair{8, cv::ROTATE_90_COUNTERCLOCKWISE}}) {
    cv::Mat upright, upright_jpeg;
    cv::rotate(stored, upright, code);
    cv::rotate(decoded, upright_jpeg, code);
    const std::vector<std::tuple<std::string, std::string, cv::Mat>> files{
        {"a.jpg", jpeg(stored, orientation, true), upright_jpeg},
        {"b.jpg", jpeg(stored, orientation, false), upright_jpeg},
        {"c.png", png(stored, orientation), upright},
        {"d.tif", tiff(stored, orientation), upright}};
    for (const auto& [name, bytes, expected] : files) {
      const TemporaryFolder folder;
      folder.write("0" + name, bytes);
      folder.write("1" + name, bytes);
      FrameSource source({.path = folder.path(), .rate_hz = 1});
      EXPECT_TRUE(source.is_rotated()) << name;
      while (const std::optional<Frame> frame = source.next()) {
        ASSERT_EQ(frame->grey.size(), expected.size()) << name << orientation;
        EXPECT_EQ(cv::norm(frame->grey, expected, cv::NORM_INF), 0) << name << orientation;
      }
      EXPECT_EQ(source.read(), 2);
    }
  }
}

TEST(ExifOrientation, UprightImagesAreUsedAsStored) {
  const TemporaryFolder folder;
  folder.write("0.png", png(gradient(), 1));
  folder.write("1.png", encoded(".png", gradient()));
  FrameSource source({.path = folder.path(), .rate_hz = 1});
  EXPECT_FALSE(source.is_rotated());
  while (const std::optional<Frame> frame = source.next()) {
    EXPECT_EQ(cv::norm(frame->grey, gradient(), cv::NORM_INF), 0);
  }
  EXPECT_EQ(source.read(), 2);
}

TEST(ExifOrientation, RotatesImagesOf16Bits) {
  const TemporaryFolder folder;
  cv::Mat deep;
  gradient().convertTo(deep, CV_16U, 256);
  for (const char* name : {"0.png", "1.png", "2.png"}) folder.write(name, png(deep, 6));
  cv::Mat upright;
  cv::rotate(gradient(), upright, cv::ROTATE_90_CLOCKWISE);
  FrameSource source({.path = folder.path(), .rate_hz = 1, .bits = 16});
  while (const std::optional<Frame> frame = source.next()) {
    ASSERT_EQ(frame->grey.size(), upright.size());
    EXPECT_EQ(cv::norm(frame->grey, upright, cv::NORM_INF), 0);
  }
  EXPECT_EQ(source.read(), 3);
}

TEST(ExifOrientation, RejectsMirroringAndChanges) {
  for (const int orientation : {2, 4, 5, 7}) {
    const TemporaryFolder folder;
    folder.write("a.jpg", jpeg(gradient(), orientation));
    EXPECT_EQ(input_error_of(folder, [&] { (void)first_frame(folder.path()); }),
              fmt::format("a.jpg: EXIF orientation {} mirrors the image, which inverts the motion "
                          "field; remove the tag from the files",
                          orientation));
  }
  const TemporaryFolder folder;
  folder.write("a.jpg", jpeg(gradient(), 1));
  folder.write("b.jpg", jpeg(gradient(), 3));
  EXPECT_EQ(input_error_of(folder,
                           [&] {
                             FrameSource source({.path = folder.path(), .rate_hz = 1});
                             while (source.next()) {
                             }
                           }),
            "b.jpg: EXIF orientation 3 differs from 1 before; remove the tag from the files, so "
            "that all images are used as stored");
}

// Damaged directories are read within their bounds.
TEST(ExifOrientation, OfDamagedFilesIsUpright) {
  const std::string whole = jpeg(gradient(), 6);
  const std::vector<unsigned char> bytes(whole.begin(), whole.end());
  EXPECT_EQ(exif_orientation(bytes), 6);
  for (std::size_t n = 0; n < 44; ++n) {
    EXPECT_EQ(exif_orientation(std::span(bytes).first(n)), 1) << n;
  }
}

}  // namespace
}  // namespace stillkite
