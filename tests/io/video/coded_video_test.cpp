#include "tests/io/video/coded_video.hpp"

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
}

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>

#include "io/text_file.hpp"
#include "io/video/frame_source.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

std::vector<Frame> frames_of(const SourceConfig& config, std::string* problem = nullptr) {
  FrameSource source(config);
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source.next()) frames.push_back(*frame);
  if (problem != nullptr) *problem = source.problem().value_or("");
  return frames;
}

// Sets the luma of 8 or 16 bits, of an equal value in each line.
void paint_lines(AVFrame& frame, const std::function<int(int)>& value_of_line) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  const int plane = format->comp[0].plane;
  std::memset(frame.buf[plane]->data, 0, frame.buf[plane]->size);  // lines are written by OR
  for (int y = 0; y < frame.height; ++y) {
    std::vector<std::uint16_t> line(static_cast<std::size_t>(frame.width),
                                    static_cast<std::uint16_t>(value_of_line(y)));
    av_write_image_line2(line.data(), frame.data, frame.linesize, format, 0, y, 0, frame.width,
                         sizeof(std::uint16_t));
  }
}

std::function<void(AVFrame&, int)> uniform(const std::function<int(int)>& value_of_image) {
  return [=](AVFrame& frame, int i) { paint_lines(frame, [&](int) { return value_of_image(i); }); };
}

double max_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

struct Stream {
  std::string file;
  std::string codec;
  std::string options;
};

// Lossless or nearly so; keyframes every 30 images, with references across them in an open GOP.
const std::vector<Stream> kX264{
    {"a.ts", "libx264", "g=30;bf=2;qp=0;preset=veryfast"},
    {"b.mpg", "libx264", "g=30;bf=2;qp=0;preset=veryfast"},
    {"c.ts", "libx264", "g=30;bf=3;qp=0;preset=veryfast;x264-params=open-gop=1"},
    {"d.mp4", "libx264", "g=30;bf=3;qp=0;preset=veryfast;x264-params=open-gop=1"},
    {"e.ts", "libx264", "g=30;bf=0;qp=0;preset=veryfast;intra-refresh=1"},
    {"f.h264", "libx264", "g=30;bf=2;qp=0;preset=veryfast"}};
const std::vector<Stream> kX265{
    {"a.ts", "libx265", "g=30;preset=ultrafast;x265-params=lossless=1:bframes=3:log-level=none"},
    {"b.mkv", "libx265", "g=30;preset=ultrafast;x265-params=lossless=1:bframes=3:log-level=none"},
    {"c.hevc", "libx265", "g=30;preset=ultrafast;x265-params=lossless=1:bframes=3:log-level=none"}};
const std::vector<Stream> kMpeg{{"a.ts", "mpeg2video", "g=30;bf=2;qmin=1;qmax=1"},
                                {"b.mpg", "mpeg2video", "g=30;bf=2;qmin=1;qmax=1"},
                                {"c.m2v", "mpeg2video", "g=30;bf=2;qmin=1;qmax=1"}};

class SeekInStream : public testing::TestWithParam<std::vector<Stream>> {};

// A run from a start time reads the images and stamps that a whole run reads from there on.
TEST_P(SeekInStream, ReadsTheSameImagesAsAWholeRun) {
  constexpr int kRate_hz = 30, kFrames = 105;
  constexpr double kRounding_s = 1e-3;  // of Matroska
  const TemporaryFolder folder;
  for (const Stream& stream : GetParam()) {
    SCOPED_TRACE(stream.file + " " + stream.codec);
    const fs::path file = write_coded_video(folder.path() / stream.file,
                                            {.codec = stream.codec,
                                             .options = stream.options,
                                             .rate_hz = kRate_hz,
                                             .frames = kFrames,
                                             .paint = uniform([](int i) { return 20 + 2 * i; })});
    const std::vector<Frame> whole = frames_of({.path = file});
    ASSERT_EQ(whole.size(), kFrames);
    for (int i = 0; i < kFrames; ++i) {
      EXPECT_NEAR(whole[i].grey.at<unsigned char>(24, 32), 20 + 2 * i, 1) << i;
      EXPECT_NEAR(to_seconds(whole[i].stamp), static_cast<double>(i) / kRate_hz, 6e-4) << i;
    }
    for (const double start_s : {0.1, 0.99, 1.5, 1.99, 3.3}) {
      std::string problem;
      const std::vector<Frame> frames = frames_of({.path = file, .start_s = start_s}, &problem);
      const auto first = static_cast<std::size_t>(
          std::count_if(whole.begin(), whole.end(),
                        [&](const Frame& frame) { return frame.stamp < from_seconds(start_s); }));
      ASSERT_EQ(frames.size(), kFrames - first) << start_s;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_NEAR(seconds_between(frames[i].stamp, whole[first + i].stamp), 0, kRounding_s)
            << start_s;
        EXPECT_EQ(max_difference(frames[i].grey, whole[first + i].grey), 0) << start_s << " " << i;
      }
      EXPECT_EQ(problem.find("truncated"), std::string::npos) << problem;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(H264, SeekInStream, testing::Values(kX264));
INSTANTIATE_TEST_SUITE_P(Hevc, SeekInStream, testing::Values(kX265));
INSTANTIATE_TEST_SUITE_P(Mpeg, SeekInStream, testing::Values(kMpeg));

TEST(BareStream, IsStampedByTheRateInItsHeaders) {
  const TemporaryFolder folder;
  for (const Stream& stream : {kX264.back(), kX265.back(), kMpeg.back()}) {
    const fs::path file = write_coded_video(folder.path() / stream.file,
                                            {.codec = stream.codec,
                                             .options = stream.options,
                                             .rate_hz = 60,
                                             .frames = 20,
                                             .paint = uniform([](int i) { return 20 + i; })});
    std::string problem;
    const std::vector<Frame> frames = frames_of({.path = file}, &problem);
    ASSERT_EQ(frames.size(), 20) << stream.file;
    for (int i = 0; i < 20; ++i) EXPECT_EQ(frames[i].stamp, from_seconds(i / 60.0));
    EXPECT_NE(problem.find("the frame rate of 60 Hz is that of the stream's headers"),
              std::string::npos)
        << problem;
    const std::vector<Frame> faster = frames_of({.path = file, .rate_hz = 120}, &problem);
    EXPECT_EQ(faster.back().stamp, from_seconds(19 / 120.0));
    EXPECT_EQ(problem, "");
  }
}

TEST(BareStream, WithoutARateNeedsSourceRate) {
  const TemporaryFolder folder;
  const std::vector<Stream> streams{
      {"a.hevc", "libx265", "x265-params=vui-timing-info=0:log-level=none"},
      {"b.mjpeg", "mjpeg", ""}};
  for (const Stream& stream : streams) {
    const fs::path file = write_coded_video(
        folder.path() / stream.file,
        {.codec = stream.codec,
         .options = stream.options,
         .format = stream.codec == "mjpeg" ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P,
         .rate_hz = 60,
         .frames = 10,
         .paint = uniform([](int i) { return 20 + i; })});
    EXPECT_EQ(
        input_error_of(folder, [&] { FrameSource({.path = file}); }),
        stream.file + ": the file has no time stamps and no frame rate; set it as source.rate_hz");
    const std::vector<Frame> frames = frames_of({.path = file, .rate_hz = 60});
    ASSERT_EQ(frames.size(), 10) << stream.file;
    EXPECT_EQ(frames.back().stamp, from_seconds(9 / 60.0));
  }
}

TEST(BareStream, CountsUndecodableImages) {
  const TemporaryFolder folder;
  const fs::path whole = write_coded_video(
      folder.path() / "a.mjpeg",
      {.codec = "mjpeg", .format = AV_PIX_FMT_YUVJ420P, .frames = 10, .paint = uniform([](int i) {
                                                                        return 20 + i;
                                                                      })});
  std::string bytes = read_bytes(whole);
  std::size_t at = 0;
  for (int i = 0; i < 5; ++i) at = bytes.find("\xFF\xC0", at + 1);  // size of image 4
  bytes.replace(at + 5, 4, 4, '\0');
  const std::vector<Frame> frames =
      frames_of({.path = folder.file("b.mjpeg", bytes), .rate_hz = 10});
  ASSERT_EQ(frames.size(), 9);
  EXPECT_EQ(frames[3].stamp, from_seconds(0.3));
  EXPECT_EQ(frames[4].stamp, from_seconds(0.5));
}

// Luma of each format is reduced to 8 bits without a change of its range.
TEST(GreyLevels, OfDeepAndPackedVideosKeepTheirRange) {
  struct Format {
    AVPixelFormat format;
    std::string codec;
    int value;
    int grey;
  };
  const TemporaryFolder folder;
  const std::vector<Format> formats{
      {AV_PIX_FMT_YUV420P10, "ffv1", 401, 100},   {AV_PIX_FMT_YUV420P10, "ffv1", 1023, 255},
      {AV_PIX_FMT_YUV420P10, "ffv1", 12, 3},      {AV_PIX_FMT_YUV420P12, "ffv1", 1612, 101},
      {AV_PIX_FMT_GRAY10, "ffv1", 40, 10},        {AV_PIX_FMT_GRAY12BE, "rawvideo", 1600, 100},
      {AV_PIX_FMT_YUYV422, "rawvideo", 250, 250}, {AV_PIX_FMT_UYVY422, "rawvideo", 3, 3}};
  for (const Format& f : formats) {
    for (const bool full_range : {false, true}) {
      const fs::path file = write_coded_video(folder.path() / "a.nut",
                                              {.codec = f.codec,
                                               .format = f.format,
                                               .full_range = full_range,
                                               .paint = uniform([&](int) { return f.value; })});
      const std::vector<Frame> frames = frames_of({.path = file});
      ASSERT_EQ(frames.size(), 1);
      EXPECT_EQ(max_difference(frames[0].grey, cv::Mat(48, 64, CV_8UC1, cv::Scalar(f.grey))), 0)
          << av_get_pix_fmt_name(f.format) << " " << f.value;
    }
  }
}

TEST(GreyLevels, Of16BitVideosNeedTheirSignificantBits) {
  const TemporaryFolder folder;
  const auto video = [&](AVPixelFormat format, int value) {
    return write_coded_video(
        folder.path() / "a.mkv",
        {.codec = "ffv1", .format = format, .paint = uniform([=](int) { return value; })});
  };
  const auto error = [&](const SourceConfig& config) {
    return input_error_of(folder, [&] { FrameSource{config}; });
  };
  const fs::path deep = video(AV_PIX_FMT_GRAY16, 400);
  EXPECT_EQ(frames_of({.path = deep, .bits = 10})[0].grey.at<unsigned char>(9, 9), 100);
  EXPECT_EQ(frames_of({.path = deep, .bits = 16})[0].grey.at<unsigned char>(9, 9), 2);
  EXPECT_EQ(error({.path = deep}),
            "a.mkv: 16-bit image with a maximum value of 400; set source.bits to the significant "
            "bits of the camera (9, or 16 for a dark scene)");
  const fs::path bright = video(AV_PIX_FMT_GRAY16, 25600);
  EXPECT_EQ(frames_of({.path = bright})[0].grey.at<unsigned char>(9, 9), 100);
  const fs::path twelve = video(AV_PIX_FMT_GRAY12, 400);
  EXPECT_EQ(frames_of({.path = twelve, .bits = 10})[0].grey.at<unsigned char>(9, 9), 100);
  EXPECT_EQ(error({.path = twelve, .bits = 14}),
            "a.mkv: 12-bit image; source.bits of 14 is out of range, allowed: 8 to 12");
}

// Equal red, green and blue are the grey level.
TEST(GreyLevels, OfRgbVideosAreTheirMean) {
  const TemporaryFolder folder;
  struct Format {
    AVPixelFormat format;
    std::string codec;
    int maximum;
  };
  for (const Format& f : {Format{AV_PIX_FMT_RGB24, "rawvideo", 255},
                          {AV_PIX_FMT_0RGB32, "ffv1", 255},
                          {AV_PIX_FMT_GBRP10, "ffv1", 1023},
                          {AV_PIX_FMT_RGB48BE, "png", 65535}}) {
    for (const int grey : {153, 255}) {
      const auto paint = [&](AVFrame& frame, int) {
        const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(f.format);
        for (int plane = 0; plane < 4 && frame.buf[plane] != nullptr; ++plane) {
          std::memset(frame.buf[plane]->data, 0, frame.buf[plane]->size);
        }
        std::vector<std::uint16_t> line(64, static_cast<std::uint16_t>(grey * f.maximum / 255));
        for (int y = 0; y < frame.height; ++y) {
          for (int c = 0; c < 3; ++c) {
            av_write_image_line2(line.data(), frame.data, frame.linesize, format, 0, y, c, 64,
                                 sizeof(std::uint16_t));
          }
        }
      };
      const fs::path file = write_coded_video(
          folder.path() / "a.nut",
          {.codec = f.codec, .format = f.format, .full_range = true, .paint = paint});
      EXPECT_NEAR(frames_of({.path = file})[0].grey.at<unsigned char>(9, 9), grey, 1)
          << av_get_pix_fmt_name(f.format);
    }
  }
}

// A ramp over the lines of the first field; those of the second are 100 brighter.
TEST(Interlacing, KeepsTheFirstFieldAndInterpolatesItsLines) {
  const TemporaryFolder folder;
  for (const std::string codec : {"libx264", "mpeg2video"}) {
    for (const bool top_first : {true, false}) {
      SCOPED_TRACE(codec + (top_first ? " top" : " bottom"));
      const auto is_first = [&](int y) { return (y % 2 == 0) == top_first; };
      const CodedVideo video{
          .codec = codec,
          .options = codec == "libx264" ? "qp=0;flags=+ildct" : "qmin=1;qmax=1;flags=+ildct+ilme",
          .rate_hz = 25,
          .frames = 5,
          .interlaced = true,
          .top_field_first = top_first,
          .paint = [&](AVFrame& frame, int i) {
            paint_lines(frame, [&](int y) { return 40 + i + 2 * y + (is_first(y) ? 0 : 100); });
          }};
      std::string problem;
      const std::vector<Frame> frames =
          frames_of({.path = write_coded_video(folder.path() / "a.mkv", video)}, &problem);
      ASSERT_EQ(frames.size(), 5);
      const int tolerance = codec == "libx264" ? 0 : 2;
      for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(frames[i].stamp, from_seconds(0.04 * i));
        for (int y = 1; y < 47; ++y) {
          EXPECT_NEAR(frames[i].grey.at<unsigned char>(y, 20), 40 + i + 2 * y, tolerance) << y;
        }
      }
      EXPECT_EQ(problem.substr(problem.rfind('/') + 1),
                "a.mkv: interlaced; of each image the first field is used and its lines are "
                "interpolated");
    }
  }
}

TEST(VideoTracks, AreSelectedByNumber) {
  const TemporaryFolder folder;
  const auto track = [&](const std::string& name, int width_px, int grey) {
    return write_coded_video(folder.path() / name, {.codec = "ffv1",
                                                    .frames = 3,
                                                    .width_px = width_px,
                                                    .paint = uniform([=](int) { return grey; })});
  };
  const fs::path file =
      join_tracks(folder.path() / "ab.mkv", {track("a.mkv", 64, 50), track("b.mkv", 32, 90)});
  for (const auto& [number, width_px, grey] : {std::array{0, 64, 50}, std::array{1, 32, 90}}) {
    std::string problem;
    const std::vector<Frame> frames = frames_of({.path = file, .track = number}, &problem);
    ASSERT_EQ(frames.size(), 3);
    EXPECT_EQ(frames[0].grey.cols, width_px);
    EXPECT_EQ(frames[0].grey.at<unsigned char>(9, 9), grey);
    EXPECT_EQ(problem, "");
  }
  std::string problem;
  EXPECT_EQ(frames_of({.path = file}, &problem).size(), 3);
  EXPECT_NE(problem.find("source.track selects another: 0 (ffv1 64x48), 1 (ffv1 32x48)"),
            std::string::npos)
      << problem;
  EXPECT_EQ(
      input_error_of(folder, [&] { FrameSource({.path = file, .track = 2}); }),
      "ab.mkv: source.track: 2 is out of range, video tracks: 0 (ffv1 64x48), 1 (ffv1 32x48)");
  EXPECT_EQ(input_error_of(folder,
                           [&] { FrameSource({.path = folder.path(), .rate_hz = 1, .track = 0}); }),
            "source.track: only for videos; remove it for a folder");
}

}  // namespace
}  // namespace stillkite
