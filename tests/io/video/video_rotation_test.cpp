#include <array>
#include <opencv2/core.hpp>

#include "io/text_file.hpp"
#include "io/video/frame_source.hpp"
#include "io/video/video_writer.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

// Three images of noise, without symmetry.
fs::path write_noise(const fs::path& file) {
  VideoWriter writer(file, {160, 96}, 25, {.crf = 0});
  cv::Mat image(96, 160, CV_8UC1);
  for (int i = 0; i < 3; ++i) {
    cv::RNG(static_cast<std::uint64_t>(i)).fill(image, cv::RNG::UNIFORM, 0, 255);
    writer.write(image);
  }
  writer.commit();
  return file;
}

std::vector<Frame> images_of(FrameSource& source) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source.next()) frames.push_back(*frame);
  return frames;
}

// Replaces a, b, c, d of the display matrix, offset unchanged (ISO/IEC 14496-12, 8.3.2).
fs::path with_matrix(const fs::path& file, std::array<int, 4> matrix) {
  std::string bytes = read_bytes(file);
  std::size_t at = bytes.find("tkhd") + 4 + 40;
  for (const int term : {matrix[0], matrix[1], 0, matrix[2], matrix[3], 0}) {
    const auto fixed = static_cast<std::uint32_t>(term) << 16;
    for (const int shift : {24, 16, 8, 0}) bytes[at++] = static_cast<char>(fixed >> shift);
  }
  fs::path rotated = fs::path(file).replace_extension("rotated.mp4");
  std::ofstream(rotated, std::ios::binary) << bytes;
  return rotated;
}

// Displayed image: pixel (x, y) is displayed at (a x + c y, b x + d y), shifted into the image
// (ISO/IEC 14496-12, 6.2.2).
cv::Mat displayed_image(const cv::Mat& coded, std::array<int, 4> matrix) {
  const auto [a, b, c, d] = matrix;
  cv::Mat displayed(a != 0 ? coded.size() : cv::Size(coded.rows, coded.cols), CV_8UC1);
  for (int y = 0; y < coded.rows; ++y) {
    for (int x = 0; x < coded.cols; ++x) {
      const int column = a * x + c * y + (a + c < 0 ? displayed.cols - 1 : 0);
      const int row = b * x + d * y + (b + d < 0 ? displayed.rows - 1 : 0);
      displayed.at<unsigned char>(row, column) = coded.at<unsigned char>(y, x);
    }
  }
  return displayed;
}

TEST(VideoRotation, FollowsDisplayMatrix) {
  const TemporaryFolder folder;
  const fs::path video = write_noise(folder.path() / "a.mp4");
  FrameSource unmarked({.path = video});
  const std::vector<Frame> coded = images_of(unmarked);
  for (const std::array<int, 4> matrix : {std::array{1, 0, 0, 1}, std::array{0, 1, -1, 0},
                                          std::array{-1, 0, 0, -1}, std::array{0, -1, 1, 0}}) {
    FrameSource source({.path = with_matrix(video, matrix)});
    EXPECT_EQ(source.is_rotated(), matrix[0] != 1);
    const std::vector<Frame> frames = images_of(source);
    ASSERT_EQ(frames.size(), coded.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const cv::Mat displayed = displayed_image(coded[i].grey, matrix);
      ASSERT_EQ(frames[i].grey.size(), displayed.size());
      EXPECT_EQ(cv::norm(frames[i].grey, displayed, cv::NORM_INF), 0);
    }
  }
}

TEST(VideoRotation, RejectsOtherAnglesAndMirroring) {
  const TemporaryFolder folder;
  const fs::path video = write_noise(folder.path() / "a.mp4");
  const auto error = [&](std::array<int, 4> matrix) {
    return input_error_of(folder, [&] { FrameSource({.path = with_matrix(video, matrix)}); });
  };
  EXPECT_EQ(error({1, 1, -1, 1}),
            "a.rotated.mp4: the display matrix rotates by 45.0 deg; only multiples of 90 deg are "
            "supported, remove the matrix from the file");
  EXPECT_NE(error({-1, 0, 0, 1}).find("mirrors the images"), std::string::npos);
  FrameSource anamorphic({.path = with_matrix(video, {2, 0, 0, 1})});
  EXPECT_EQ(images_of(anamorphic).size(), 3);
  EXPECT_NE(anamorphic.problem().value_or("").find("non-square pixels, aspect ratio 2:1"),
            std::string::npos);
}

}  // namespace
}  // namespace stillkite
