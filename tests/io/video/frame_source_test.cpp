#include "io/video/frame_source.hpp"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "tests/io/temporary_folder.hpp"
#include "tests/io/video/frames.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 60;
constexpr double kRate_hz = 30;

fs::path write_video(const fs::path& file, int frames = kFrames, cv::Size size = {160, 96}) {
  cv::VideoWriter writer(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                         kRate_hz, size, true);
  EXPECT_TRUE(writer.isOpened());
  for (int i = 0; i < frames; ++i) {
    cv::Mat bgr;
    cv::cvtColor(image(i, size), bgr, cv::COLOR_GRAY2BGR);
    // incompressible, so that a truncation hits an image
    cv::Mat noise(size.height / 2, size.width, CV_8UC3);
    cv::RNG(static_cast<std::uint64_t>(i)).fill(noise, cv::RNG::UNIFORM, 0, 255);
    noise.copyTo(bgr.rowRange(0, size.height / 2));
    writer.write(bgr);
  }
  return file;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(FrameSource, ReadsEveryVideoFrameWithItsTimeStamp) {
  const TemporaryFolder folder;
  FrameSource source({.path = write_video(folder.path() / "a.mp4")});
  EXPECT_EQ(source.expected(), kFrames);
  EXPECT_EQ(source.first().grey.size(), cv::Size(160, 96));
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), kFrames);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(frames[i].index, i);
    EXPECT_NEAR(to_seconds(frames[i].stamp), i / kRate_hz, 1e-8);
    // video range: 16 + 219/255 grey
    EXPECT_NEAR(brightness(frames[i]), 16 + (40 + 2 * i) * 219.0 / 255.0, 4.0) << i;
  }
  EXPECT_EQ(source.read(), kFrames);
  EXPECT_GT(source.decoding_s(), 0);
  EXPECT_EQ(source.rejected(), 0);
  EXPECT_FALSE(source.problem().has_value());
}

TEST(FrameSource, ReadsFramesBetweenStartAndEnd) {
  const TemporaryFolder folder;
  const fs::path video = write_video(folder.path() / "a.mp4");
  FrameSource source({.path = video, .start_s = 0.99, .end_s = 1.51});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 16u);  // frames 30 to 45
  EXPECT_NEAR(to_seconds(frames[0].stamp), 1.0, 1e-8);
  EXPECT_NEAR(brightness(frames[0]), 16 + 100 * 219.0 / 255.0, 4.0);
  EXPECT_EQ(frames[0].index, 0);
  EXPECT_FALSE(source.problem().has_value());
  EXPECT_THROW(FrameSource({.path = video, .start_s = 100}), InputError);
  EXPECT_THROW(FrameSource({.path = video, .start_s = 1, .end_s = 0.5}), InputError);
}

TEST(FrameSource, RateReplacesTimeStamps) {
  const TemporaryFolder folder;
  FrameSource source(
      {.path = write_video(folder.path() / "a.mp4"), .start_s = 1.0, .rate_hz = 10.0});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 50u);
  EXPECT_EQ(frames[0].stamp, from_seconds(1.0));
  EXPECT_EQ(frames[1].stamp, from_seconds(1.1));
}

TEST(FrameSource, ReadsAndReportsATruncatedVideo) {
  const TemporaryFolder folder;
  // an AVI has its header at the beginning
  const std::string whole = bytes_of(write_video(folder.path() / "a.avi"));
  const fs::path cut = folder.file("cut.avi", whole.substr(0, whole.size() * 6 / 10));
  FrameSource source({.path = cut});
  const std::size_t n = read_all(source).size();
  EXPECT_GT(n, 20u);
  EXPECT_LT(n, 50u);
  ASSERT_TRUE(source.problem().has_value());
  EXPECT_NE(source.problem()->find("cut.avi: truncated file: images end at"), std::string::npos)
      << *source.problem();
}

TEST(FrameSource, SkipsAndReportsDamagedFrames) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of(write_video(folder.path() / "a.avi"));
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 4000; ++i) bytes[i] = '\x5a';
  FrameSource source({.path = folder.file("damaged.avi", bytes)});
  const std::size_t n = read_all(source).size();
  EXPECT_GT(n, 40u);
  EXPECT_LT(n, static_cast<std::size_t>(kFrames));
  EXPECT_EQ(source.read() - source.rejected(), static_cast<std::int64_t>(n));
  ASSERT_TRUE(source.problem());
  EXPECT_NE(source.problem()->find("images predicted from them are damaged"), std::string::npos);
}

TEST(FrameSource, ErrorsNameFileAndRemedy) {
  const TemporaryFolder folder;
  const fs::path video = write_video(folder.path() / "v.mp4", 2);
  EXPECT_EQ(input_error_of(folder, [&] { FrameSource({.path = video, .bits = 12}); }),
            "v.mp4: 8-bit image; source.bits is only for images of more than 8 bits, remove it");
  const auto error = [&](const fs::path& path) {
    return input_error_of(folder, [&] { FrameSource({.path = path}); });
  };
  EXPECT_EQ(error(folder.path() / "none.mp4"),
            "none.mp4: no such file or folder; check source.path");
  EXPECT_EQ(error(folder.file("empty.mp4", "")), "empty.mp4: the file is empty");
  EXPECT_EQ(error(folder.file("text.mp4", "this is no video\n")),
            "text.mp4: not a video file, or its header or index is missing (interrupted "
            "recording or download)");
  EXPECT_EQ(error(folder.file("a.webp", "RIFF")),
            "a.webp: a single image; set source.path to the folder of the images, or convert "
            "animated images and pages to a video");
  const std::string mp4 = bytes_of(write_video(folder.path() / "a.mp4"));
  EXPECT_NE(error(folder.file("cut.mp4", mp4.substr(0, mp4.size() / 2))).find("index is missing"),
            std::string::npos);  // the index of an MP4 is at the end
  fs::create_directories(folder.path() / "bare");
  EXPECT_NE(error(folder.path() / "bare").find("no image (png"), std::string::npos);
  EXPECT_NE(error({}).find("source.path is not set"), std::string::npos);
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(error(folder.path() / "pipe"),
            "pipe: is a pipe or a device, expected a file or a folder");
}

TEST(FrameSource, ReusesOnlyReleasedBuffers) {
  const TemporaryFolder folder;
  FrameSource source({.path = write_video(folder.path() / "a.mp4")});
  std::vector<const unsigned char*> buffers;
  std::optional<Frame> before;
  while (std::optional<Frame> frame = source.next()) {
    if (before) {
      const int i = static_cast<int>(before->index);
      EXPECT_NEAR(brightness(*before), 16 + (40 + 2 * i) * 219.0 / 255.0, 4.0) << i;
    }
    before = frame;
    if (std::find(buffers.begin(), buffers.end(), frame->grey.data) == buffers.end()) {
      buffers.push_back(frame->grey.data);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_LE(buffers.size(), 18u);  // 4 decoded ahead, 8 whose stamps are compared, those in use
}

TEST(FrameSource, CanBeDestroyedBeforeTheEnd) {
  const TemporaryFolder folder;
  const fs::path video = write_video(folder.path() / "a.mp4");
  for (int i = 0; i < 20; ++i) {
    FrameSource source({.path = video});
    EXPECT_TRUE(source.next());
    FrameSource other = std::move(source);
    EXPECT_TRUE(other.next());
  }
}

}  // namespace
}  // namespace stillkite
