#include <array>
#include <opencv2/core.hpp>

#include "io/text_file.hpp"
#include "io/video/frame_source.hpp"
#include "io/video/video_writer.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

// Three images, in which no two places are alike.
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

// Writes another matrix and, of its last row's place, nothing: see ISO/IEC 14496-12, 8.3.2.
fs::path with_matrix(const fs::path& file, std::array<int, 4> abcd) {
  std::string bytes = read_text_file(file);
  std::size_t at = bytes.find("tkhd") + 4 + 40;
  for (const int term : {abcd[0], abcd[1], 0, abcd[2], abcd[3], 0}) {
    const auto fixed = static_cast<std::uint32_t>(term) << 16;
    for (const int shift : {24, 16, 8, 0}) bytes[at++] = static_cast<char>(fixed >> shift);
  }
  fs::path turned = fs::path(file).replace_extension("turned.mp4");
  std::ofstream(turned, std::ios::binary) << bytes;
  return turned;
}

// By the standard, 6.2.2: the pixel (x, y) is shown at (a x + c y, b x + d y), moved into the
// image.
cv::Mat shown_by(const cv::Mat& coded, std::array<int, 4> abcd) {
  const auto [a, b, c, d] = abcd;
  cv::Mat shown(a != 0 ? coded.size() : cv::Size(coded.rows, coded.cols), CV_8UC1);
  for (int y = 0; y < coded.rows; ++y) {
    for (int x = 0; x < coded.cols; ++x) {
      const int column = a * x + c * y + (a + c < 0 ? shown.cols - 1 : 0);
      const int row = b * x + d * y + (b + d < 0 ? shown.rows - 1 : 0);
      shown.at<unsigned char>(row, column) = coded.at<unsigned char>(y, x);
    }
  }
  return shown;
}

TEST(VideoTurn, IsMadeAsTheMarkSays) {
  const TemporaryFolder folder;
  const fs::path video = write_noise(folder.path() / "a.mp4");
  FrameSource unmarked({.path = video});
  const std::vector<Frame> coded = images_of(unmarked);
  for (const std::array<int, 4> abcd : {std::array{1, 0, 0, 1}, std::array{0, 1, -1, 0},
                                        std::array{-1, 0, 0, -1}, std::array{0, -1, 1, 0}}) {
    FrameSource source({.path = with_matrix(video, abcd)});
    EXPECT_EQ(source.is_turned(), abcd[0] != 1);
    const std::vector<Frame> frames = images_of(source);
    ASSERT_EQ(frames.size(), coded.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const cv::Mat shown = shown_by(coded[i].grey, abcd);
      ASSERT_EQ(frames[i].grey.size(), shown.size());
      EXPECT_EQ(cv::norm(frames[i].grey, shown, cv::NORM_INF), 0);
    }
  }
}

TEST(VideoTurn, OfAnotherKindIsRefused) {
  const TemporaryFolder folder;
  const fs::path video = write_noise(folder.path() / "a.mp4");
  const auto error = [&](std::array<int, 4> abcd) {
    return input_error_of(folder, [&] { FrameSource({.path = with_matrix(video, abcd)}); });
  };
  EXPECT_EQ(error({1, 1, -1, 1}),
            "a.turned.mp4: its images are marked to be shown turned by 45.0 deg; only quarter "
            "turns can be made, take the mark out of the file");
  EXPECT_NE(error({-1, 0, 0, 1}).find("shown mirrored"), std::string::npos);
  FrameSource oblong({.path = with_matrix(video, {2, 0, 0, 1})});
  EXPECT_EQ(images_of(oblong).size(), 3);
  EXPECT_NE(oblong.complaint().value_or("").find("its pixels are told to be 2:1"),
            std::string::npos);
}

}  // namespace
}  // namespace stillkite
