#include "io/video/image_sequence.hpp"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/io/temporary_folder.hpp"
#include "tests/io/video/frames.hpp"

// Folders of images and EuRoC data sets, read by a FrameSource.

namespace stillkite {
namespace {

namespace fs = std::filesystem;

TEST(ImageSequence, ReadsImageFoldersInNumericOrder) {
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

TEST(ImageSequence, TreatsSkippedNumbersAsMissingImages) {
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
TEST(ImageSequence, TreatsGapsBetweenStampNamesAsMissingImages) {
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

TEST(ImageSequence, RejectsSeveralSeriesOfImages) {
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

TEST(ImageSequence, IgnoresHiddenFilesAndRejectsPages) {
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

TEST(ImageSequence, ScalesImagesOf16BitsByTheirSignificantBits) {
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

}  // namespace
}  // namespace stillkite
