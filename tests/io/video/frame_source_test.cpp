#include "io/video/frame_source.hpp"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 60;
constexpr double kRate_hz = 30;

// Grey level encodes the frame index, to check order and content after compression.
cv::Mat image(int index, cv::Size size = {160, 96}) {
  return cv::Mat(size, CV_8UC1, cv::Scalar(40 + 2 * index));
}

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

std::vector<Frame> read_all(FrameSource& source) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source.next()) frames.push_back(*frame);
  return frames;
}

// Grey level in the uniform half of the image.
double brightness(const Frame& frame) {
  return frame.grey.at<unsigned char>(frame.grey.rows * 3 / 4, frame.grey.cols / 2);
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

TEST(FrameSource, ReadsImageFoldersInNumericOrder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 12; ++i) {
    cv::imwrite((folder.path() / fmt::format("f{}.png", i)).string(), image(i));
  }
  EXPECT_NE(
      input_error_of(folder, [&] { FrameSource({.path = folder.path()}); }).find("source.rate_hz"),
      std::string::npos);
  FrameSource source({.path = folder.path(), .rate_hz = 4.0});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 12u);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(frames[i].stamp, from_seconds(0.25 * i));
    EXPECT_EQ(brightness(frames[i]), 40 + 2 * i);
  }
}

TEST(FrameSource, TreatsSkippedNumbersAsMissingImages) {
  const auto stamps_s = [](const std::vector<std::string>& names) {
    const TemporaryFolder folder;
    for (const std::string& name : names) cv::imwrite((folder.path() / name).string(), image(0));
    FrameSource source({.path = folder.path(), .rate_hz = 1});
    std::vector<double> stamps;
    for (const Frame& frame : read_all(source)) stamps.push_back(to_seconds(frame.stamp));
    return stamps;
  };
  EXPECT_EQ(stamps_s({"a_8.png", "a_9.png", "a_11.png"}), (std::vector<double>{0, 1, 3}));
  EXPECT_EQ(stamps_s({"10.png", "20.png", "40.png"}), (std::vector<double>{0, 1, 3}));
  EXPECT_EQ(stamps_s({"1000.png", "1033.png", "1067.png"}), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(stamps_s({"a1.png", "a3.png", "b4.png"}), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(stamps_s({"a.png", "b.png"}), (std::vector<double>{0, 1}));
  EXPECT_EQ(stamps_s({"1.png", "2.png", "999999999999999999.png"}), (std::vector<double>{0, 1, 2}));
}

// Most 16-bit image files use the lowest 10, 12 or 14 bits only.
TEST(FrameSource, TreatsGapsBetweenStampNamesAsMissingImages) {
  const auto frames_of = [](const std::vector<std::string>& names, double rate_hz) {
    const TemporaryFolder folder;
    for (const std::string& name : names) {
      cv::imwrite((folder.path() / name).string(), image(0));
    }
    FrameSource source({.path = folder.path(), .rate_hz = rate_hz});
    std::vector<double> frames;
    for (const Frame& frame : read_all(source)) {
      frames.push_back(std::round(to_seconds(frame.stamp) * rate_hz));
    }
    return frames;
  };
  const std::vector<double> expected{0, 1, 4, 5};
  EXPECT_EQ(frames_of({"1403636579763555584.png", "1403636579813555456.png",
                       "1403636579963555584.png", "1403636580013555200.png"},
                      20),
            expected);
  EXPECT_EQ(frames_of({"1305031102.175304.png", "1305031102.211214.png", "1305031102.311267.png",
                       "1305031102.343233.png"},
                      30),
            (std::vector<double>{0, 1, 4, 5}));
  // two rates contradict each other
  EXPECT_THROW(frames_of({"1403636579763555584.png", "1403636579813555456.png"}, 30), InputError);
}

TEST(FrameSource, RejectsSeveralSeriesOfImages) {
  const auto error_of = [](const std::vector<std::string>& names) {
    const TemporaryFolder folder;
    for (const std::string& name : names) {
      cv::imwrite((folder.path() / name).string(), image(0));
    }
    return input_error_of(folder, [&] { FrameSource({.path = folder.path(), .rate_hz = 30}); });
  };
  EXPECT_NE(error_of({"left_1.png", "left_2.png", "right_1.png", "right_2.png"})
                .find("two series of images with equal numbers, left_#.png (2 images) and "
                      "right_#.png (2)"),
            std::string::npos);
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"cam0_1.png", "cam1_1.png", "cam0_2.png", "cam1_2.png"},
        {"1.png", "2.png", "1_thumb.png", "2_thumb.png"},
        {"1.png", "2.png", "1.jpg", "2.jpg"},
        {"f_-2.png", "f_-1.png", "f_1.png", "f_2.png"}}) {
    EXPECT_NE(error_of(names), "accepted") << names[1];
  }
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"a1.png", "a2.png", "b3.png", "b4.png"},
        {"20260101_120000_0.png", "20260101_120000_1.png", "20260101_120001_0.png",
         "20260101_120001_1.png"},
        {"a.png", "b.png", "c.png"}}) {
    EXPECT_EQ(error_of(names), "accepted") << names[1];
  }
}

TEST(FrameSource, IgnoresHiddenFilesAndRejectsPages) {
  const TemporaryFolder folder;
  cv::imwrite((folder.path() / "1.png").string(), image(1));
  folder.write("._1.png", "resource fork");
  FrameSource source({.path = folder.path(), .rate_hz = 30});
  EXPECT_EQ(read_all(source).size(), 1u);
  EXPECT_EQ(source.rejected(), 0);
  const TemporaryFolder pages;
  ASSERT_TRUE(cv::imwritemulti((pages.path() / "all.tif").string(),
                               std::vector<cv::Mat>{image(0), image(1), image(2)}));
  EXPECT_EQ(input_error_of(pages, [&] { FrameSource({.path = pages.path(), .rate_hz = 30}); }),
            "all.tif: 3 pages; split the file into images of one page");
}

TEST(FrameSource, ScalesImagesOf16BitsByTheirSignificantBits) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    cv::Mat deep(96, 160, CV_16UC1, cv::Scalar(16 * (100 + i)));
    deep.at<unsigned short>(0, 0) = 4095;
    cv::imwrite((folder.path() / fmt::format("{}.png", i)).string(), deep);
  }
  FrameSource source({.path = folder.path(), .rate_hz = 20, .bits = 12});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 3);
  for (int i = 0; i < 3; ++i) {
    const Frame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.grey.type(), CV_8UC1);
    EXPECT_EQ(frame.grey.at<unsigned char>(50, 50), 100 + i);
    EXPECT_EQ(frame.grey.at<unsigned char>(0, 0), 255);
  }
  EXPECT_EQ(input_error_of(folder, [&] { FrameSource({.path = folder.path(), .rate_hz = 20}); }),
            "0.png: 16-bit image with a maximum value of 4095; set source.bits to the significant "
            "bits of "
            "the camera (12, or 16 for a dark scene)");
  cv::imwrite((folder.path() / "8.bmp").string(), image(0));
  const SourceConfig late{.path = folder.path(), .start_s = 0.14, .rate_hz = 20, .bits = 12};
  EXPECT_EQ(input_error_of(folder, [&] { FrameSource{late}; }),
            "8.bmp: 8-bit image; source.bits is only for images of more than 8 bits, remove it");
  FrameSource all({.path = folder.path(), .rate_hz = 20, .bits = 16});
  EXPECT_EQ(read_all(all).front().grey.at<unsigned char>(50, 50), 6);
}

class EurocSource : public testing::Test {
 protected:
  void write(const std::string& csv) { folder_.write("mav0/cam0/data.csv", csv); }
  void write_image(const std::string& name, const cv::Mat& image) {
    fs::create_directories(folder_.path() / "mav0/cam0/data");
    cv::imwrite((folder_.path() / "mav0/cam0/data" / name).string(), image);
  }
  TemporaryFolder folder_;
};

TEST_F(EurocSource, ReadsTimeStampsFromAnyFolderLevel) {
  write("#timestamp [ns],filename\n1403715273262142976,a.png\n1403715273312143104,b.png\n");
  write_image("a.png", image(1));
  cv::Mat colour;
  cv::cvtColor(image(2), colour, cv::COLOR_GRAY2BGR);
  write_image("b.png", colour);
  for (const char* at : {"", "mav0", "mav0/cam0"}) {
    FrameSource source({.path = folder_.path() / at});
    const std::vector<Frame> frames = read_all(source);
    ASSERT_EQ(frames.size(), 2u) << at;
    EXPECT_EQ(frames[0].stamp.ns, 1403715273262142976) << at;
    EXPECT_EQ(frames[1].grey.type(), CV_8UC1);
    EXPECT_EQ(brightness(frames[1]), 44);
  }
}

class BurstSource : public EurocSource {
 protected:
  // Pairs of images 1 ms apart, at 30 images per second.
  void SetUp() override {
    std::string csv;
    for (int i = 0; i < kImages; ++i) {
      const std::string name = fmt::format("{}.png", i);
      const int late_ms = i % 2 == 0 ? 32 : 0;
      csv += fmt::format("{},{}\n", kFirst_ns + i * 33'000'000LL + late_ms * 1'000'000LL, name);
      write_image(name, image(i));
    }
    write(csv);
  }
  static constexpr int kImages = 40;
  static constexpr std::int64_t kFirst_ns = 1403715273262142976;
};

TEST_F(BurstSource, RespacesAndReportsBursts) {
  FrameSource source({.path = folder_.path()});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), std::size_t{kImages});
  for (std::size_t i = 8; i < frames.size(); ++i) {
    EXPECT_NEAR(seconds_between(frames[i - 1].stamp, frames[i].stamp), 0.033, 1e-5) << i;
  }
  EXPECT_NE(source.problem().value_or("").find(": 20 of 40 images came in bursts"),
            std::string::npos)
      << source.problem().value_or("");
}

TEST_F(BurstSource, RateReplacesTimeStamps) {
  FrameSource source({.path = folder_.path(), .rate_hz = 25});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), std::size_t{kImages});
  const std::int64_t first_ns = kFirst_ns + 32'000'000;
  for (int i = 0; i < kImages; ++i) EXPECT_EQ(frames[i].stamp.ns, first_ns + i * 40'000'000LL);
  EXPECT_FALSE(source.problem().has_value());
}

// Stamps rounded to 0.1 s, and a clock that is reset.
TEST_F(EurocSource, RateReplacesStampsThatDoNotIncrease) {
  for (const char* name : {"a.png", "b.png", "c.png", "d.png"}) write_image(name, image(1));
  write("1000000000,a.png\n1000000000,b.png\n1100000000,c.png\n0,d.png\n");
  FrameSource source({.path = folder_.path(), .rate_hz = 20});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 4u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(to_seconds(frames[i].stamp), 1 + 0.05 * static_cast<double>(i), 1e-9);
  }
}

TEST_F(EurocSource, ErrorsNameFileAndLine) {
  const auto error = [&](const std::string& csv) {
    write(csv);
    return input_error_of(folder_, [&] {
      FrameSource source({.path = folder_.path()});
      (void)read_all(source);
    });
  };
  write_image("a.png", image(1));
  write_image("b.png", image(2));
  write_image("small.png", image(3, {80, 48}));
  EXPECT_EQ(error("1,a.png\n2,c.png\n"),
            "mav0/cam0/data.csv:2: the image mav0/cam0/data/c.png is missing");
  EXPECT_EQ(
      error("2,a.png\n1,b.png\n"),
      "mav0/cam0/data.csv:2: time stamp 1 is earlier than that of line 1; sort the file and remove "
      "duplicates; source.rate_hz counts the images instead");
  EXPECT_EQ(error("2,a.png\n2,b.png\n"),
            "mav0/cam0/data.csv:2: time stamp 2 repeats that of line 1; sort the file and remove "
            "duplicates; source.rate_hz counts the images instead");
  EXPECT_EQ(error("#t,name\n"), "mav0/cam0/data.csv: no image listed");
  EXPECT_EQ(error("1000000,a.png\n1033333,b.png\n"),
            "mav0/cam0/data.csv: the images are 0.0333 ms apart; time stamps must be "
            "nanoseconds, not microseconds");
  EXPECT_EQ(error("1000000000,a.png\n2000000000,small.png\n"),
            "mav0/cam0/data/small.png: image size 80x48 differs from 160x96 before; one "
            "calibration needs one size");
}

TEST_F(EurocSource, CountsUndecodableImages) {
  write("1000000000,a.png\n2000000000,bad.png\n3000000000,b.png\n");
  write_image("a.png", image(1));
  write_image("b.png", image(2));
  folder_.write("mav0/cam0/data/bad.png", "no image");
  FrameSource source({.path = folder_.path()});
  const std::vector<Frame> frames = read_all(source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].index, 2);
  EXPECT_EQ(source.read(), 3);
  EXPECT_EQ(source.rejected(), 1);
  EXPECT_NE(source.problem().value_or("").find("1 of "), std::string::npos);
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
