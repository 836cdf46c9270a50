#include "live/stream/video_capture.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

extern "C" {
#include <libavutil/frame.h>
}

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <opencv2/core.hpp>
#include <thread>

#include "live/clock/local_clock.hpp"
#include "live/record/flight_replay.hpp"
#include "tests/io/video/coded_video.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kPacket_bytes = 188;
constexpr int kRate_hz = 30, kFirstLuma = 40, kLumaStep = 2;

cv::Mat grey_of(const AVFrame& image, cv::Mat recycled) {
  recycled.create(image.height, image.width, CV_8UC1);
  for (int row = 0; row < image.height; ++row) {
    std::memcpy(recycled.ptr(row), image.data[0] + row * image.linesize[0],
                static_cast<std::size_t>(image.width));
  }
  return recycled;
}

class Capture : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  // MPEG-TS of images whose luma is their number.
  [[nodiscard]] std::string coded(int frames, int width_px) const {
    const fs::path file = write_coded_video(
        folder / "video.ts", {.codec = "libx264",
                              .options = "preset=ultrafast;tune=zerolatency;qp=4;g=5",
                              .rate_hz = kRate_hz,
                              .frames = frames,
                              .width_px = width_px,
                              .paint = [](AVFrame& frame, int i) {
                                std::memset(
                                    frame.data[0], kFirstLuma + kLumaStep * i,
                                    static_cast<std::size_t>(frame.linesize[0]) * frame.height);
                              }});
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  // Sends MPEG-TS over UDP, one image per frame interval.
  void send(const std::string& bytes) const {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto start = std::chrono::steady_clock::now();
    int images = 0;
    for (std::size_t at = 0; at + kPacket_bytes <= bytes.size(); at += kPacket_bytes) {
      if (begins_image(bytes.substr(at, kPacket_bytes))) {
        std::this_thread::sleep_until(start +
                                      std::chrono::duration<double>(double(images++) / kRate_hz));
      }
      sendto(descriptor, bytes.data() + at, kPacket_bytes, 0,
             reinterpret_cast<const sockaddr*>(&to), sizeof(to));
    }
    close(descriptor);
  }

  // Payload unit start of the video's packets.
  static bool begins_image(const std::string& packet) {
    constexpr unsigned kVideo = 256, kStart = 0x40;
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(packet[i]); };
    return (((byte(1) & 0x1fU) << 8) | byte(2)) == kVideo && (byte(1) & kStart) != 0;
  }

  [[nodiscard]] StreamConfig source() const {
    return {.path = "udp://127.0.0.1:" + std::to_string(port), .timeout_s = 0.4};
  }
  VideoCapture::Report report() {
    return [this](const std::string& message) {
      const std::lock_guard lock(mutex);
      messages += message + '\n';
    };
  }
  [[nodiscard]] bool has_reported(const std::string& text) {
    const std::lock_guard lock(mutex);
    return messages.find(text) != std::string::npos;
  }

  const fs::path folder =
      fs::temp_directory_path() / ("stillkite_capture_" + std::to_string(getpid()));
  const std::uint16_t port = static_cast<std::uint16_t>(20'000 + getpid() % 20'000);
  std::mutex mutex;
  std::string messages;
};

int number_of(const cv::Mat& grey) {
  return static_cast<int>(
      std::lround((grey.at<std::uint8_t>(8, 8) - kFirstLuma) / double(kLumaStep)));
}

TEST_F(Capture, KeepsTheNewestImageAndCountsReplacedOnes) {
  constexpr int kFrames = 60;
  const std::string bytes = coded(kFrames, 64);
  VideoCapture capture(source(), grey_of, report(), nullptr);
  std::thread sender([&] { send(bytes); });
  int taken = 0, last = -1;
  while (const auto captured = capture.next(1)) {
    ++taken;
    EXPECT_GT(number_of(captured->frame.grey), last);
    last = number_of(captured->frame.grey);
    // the last image is complete at the time-out: no other follows
    if (last < kFrames - 1) {
      EXPECT_LE(seconds_between(captured->frame.stamp, captured->arrival), 0.1);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
  }
  sender.join();
  const CaptureCounts counts = capture.counts();
  EXPECT_GT(taken, 3);
  EXPECT_GT(counts.replaced, 2 * taken);
  EXPECT_EQ(counts.decoded, taken + counts.replaced + counts.rejected);
  EXPECT_GE(last, kFrames - 5);
}

TEST_F(Capture, OpensTheSourceAgainAndRejectsAnotherSize) {
  const std::string first = coded(30, 64), second = coded(30, 96);
  VideoCapture capture(source(), grey_of, report(), nullptr);
  const auto take_all = [&] {
    int taken = 0;
    while (capture.next(0.6)) ++taken;
    return taken;
  };
  send(first);
  EXPECT_GT(take_all(), 0);
  EXPECT_TRUE(has_reported("no packet for 0.4 s"));
  send(first);
  EXPECT_GT(take_all(), 0);
  EXPECT_EQ(capture.counts().sessions, 2);
  send(second);
  EXPECT_EQ(take_all(), 0);
  EXPECT_TRUE(has_reported("images of 96x48 are rejected; the calibration is for 64x48"));
}

TEST_F(Capture, RecordReturnsTheSameImages) {
  const fs::path record_folder = folder / "record";
  std::vector<Frame> used;
  {
    FlightRecord record(record_folder);
    VideoCapture capture(source(), grey_of, report(), &record);
    const std::string bytes = coded(36, 64);
    std::thread sender([&] { send(bytes); });
    while (const auto captured = capture.next(1)) {
      used.push_back(captured->frame);
      used.back().grey = captured->frame.grey.clone();
      record.add_frame({.index = captured->frame.index,
                        .stamp = captured->frame.stamp,
                        .stamp_sigma_s = captured->frame.stamp_sigma_s});
    }
    sender.join();
  }
  ASSERT_GT(used.size(), 5U);
  FlightReplay replay(record_folder, grey_of);
  for (const Frame& frame : used) {
    const std::optional<ReplayedFrame> replayed = replay.next();
    ASSERT_TRUE(replayed);
    EXPECT_EQ(replayed->frame.index, frame.index);
    EXPECT_EQ(replayed->frame.stamp, frame.stamp);
    EXPECT_EQ(replayed->frame.stamp_sigma_s, frame.stamp_sigma_s);
    EXPECT_EQ(cv::norm(replayed->frame.grey, frame.grey, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(replay.next());
}

TEST_F(Capture, EndsAtOnceWhileItWaitsForAPacket) {
  const Timestamp start = local_now();
  { const VideoCapture capture(source(), grey_of, report(), nullptr); }
  EXPECT_LT(seconds_between(start, local_now()), 0.5);
}

}  // namespace
}  // namespace stillkite
