#include "io/video/video_writer.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "io/text_file.hpp"
#include "io/video/video_reader.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

constexpr int kWritten = 40;

// Pattern with all grey levels, moving 2 px per frame.
cv::Mat image_of_frame(int frame) {
  cv::Mat grey(96, 128, CV_8UC1);
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      grey.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>((2 * (column + 2 * frame) + row) & 255);
    }
  }
  return grey;
}

void encode_pattern(const std::filesystem::path& file, double rate_hz,
                    const EncoderConfig& config) {
  VideoWriter writer(file, {128, 96}, rate_hz, config);
  for (int frame = 0; frame < kWritten; ++frame) writer.write(image_of_frame(frame));
  writer.commit();
}

TEST(VideoWriter, LosslessVideoReadsBackEqual) {
  const TemporaryFolder folder;
  for (const double rate_hz : {25.0, 30.0, 29.97}) {
    const auto file = folder.path() / "flight.mp4";
    encode_pattern(file, rate_hz, {.crf = 0, .preset = EncoderPreset::ultrafast});
    VideoReader reader({.path = file});
    for (int frame = 0; frame < kWritten; ++frame) {
      const ReadResult result = reader.read({});
      ASSERT_EQ(result.status, ReadResult::Status::frame) << frame;
      EXPECT_EQ(cv::norm(result.frame.grey, image_of_frame(frame), cv::NORM_INF), 0) << frame;
      EXPECT_NEAR(to_seconds(result.frame.stamp), frame / rate_hz, 1e-5) << frame;
    }
  }
}

TEST(VideoWriter, TimeStampsOfIntegerRatesAreExact) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "flight.mp4";
  encode_pattern(file, 25, {});
  VideoReader reader({.path = file});
  for (int frame = 0; frame < kWritten; ++frame) {
    EXPECT_EQ(reader.read({}).frame.stamp.ns, frame * 40'000'000LL);
  }
}

TEST(VideoWriter, IsDeterministic) {
  const TemporaryFolder folder;
  encode_pattern(folder.path() / "a.mp4", 25, {});
  encode_pattern(folder.path() / "b.mp4", 25, {});
  EXPECT_EQ(read_bytes(folder.path() / "a.mp4"), read_bytes(folder.path() / "b.mp4"));
}

// Uniform areas, since 4:2:0 subsamples chroma.
TEST(VideoWriter, PreservesColours) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "overlay.mp4";
  const cv::Scalar left(200, 60, 40);
  const cv::Scalar right(30, 160, 220);
  cv::Mat drawn(96, 128, CV_8UC3, left);
  drawn.colRange(64, 128).setTo(right);
  VideoWriter writer(file, drawn.size(), 25, {.crf = 10});
  for (int frame = 0; frame < 5; ++frame) writer.write(drawn);
  writer.commit();
  cv::VideoCapture capture(file.string());
  cv::Mat shown;
  ASSERT_TRUE(capture.read(shown));
  const auto mean_error = [&](const cv::Range& columns, const cv::Scalar& colour) {
    return cv::norm(cv::mean(shown.colRange(columns)) - colour, cv::NORM_INF);
  };
  EXPECT_LT(mean_error({4, 60}, left), 6);
  EXPECT_LT(mean_error({68, 124}, right), 6);
}

TEST(VideoWriter, RemovesFileWithoutCommit) {
  const TemporaryFolder folder;
  {
    VideoWriter writer(folder.path() / "flight.mp4", {128, 96}, 25, {});
    writer.write(image_of_frame(0));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoWriter, RejectsOddSizesAndMissingFolders) {
  const TemporaryFolder folder;
  EXPECT_EQ(input_error_of(folder,
                           [&] {
                             VideoWriter(folder.path() / "a.mp4", {127, 96}, 25, {});
                           }),
            "a.mp4: H.264 needs an even width and height, not 127x96");
  EXPECT_EQ(
      input_error_of(folder,
                     [&] {
                       VideoWriter(folder.path() / "no/a.mp4", {128, 96}, 25, {});
                     }),
      "no/a.mp4: cannot be created: No such file or directory; choose another folder with --out");
}

}  // namespace
}  // namespace stillkite
