#include "live/record/flight_files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "live/record/flight_record.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

class FlightFiles : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder); }
  void TearDown() override { fs::remove_all(folder); }

  void append(const char* name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::app) << text;
  }

  const fs::path folder =
      fs::temp_directory_path() / ("stillkite_flight_" + std::to_string(getpid()));
};

LibavHandle<AVCodecParameters> h264() {
  LibavHandle<AVCodecParameters> codec(avcodec_parameters_alloc());
  codec->codec_type = AVMEDIA_TYPE_VIDEO;
  codec->codec_id = AV_CODEC_ID_H264;
  codec->width = 640;
  codec->height = 480;
  return codec;
}

TEST_F(FlightFiles, RowsAreRestoredBitForBit) {
  const double sigma_s = std::nextafter(1e-3, 1);
  {
    FlightRecord record(folder);
    record.begin_session(*h264(), {1, 90'000});
    const LibavHandle<AVPacket> packet(av_packet_alloc());
    ASSERT_EQ(av_new_packet(packet.get(), 3), 0);
    packet->pts = 1234;
    record.add_packet(*packet, {77});
    record.add_frame(
        {.index = 5, .stamp = {-8}, .stamp_sigma_s = sigma_s, .telemetry = 2, .decision = {99}});
    record.add_frame({.index = 6,
                      .outcome = FrameOutcome::settling,
                      .stamp_sigma_s = std::numeric_limits<double>::infinity()});
    record.add_message({.arrival = {99}, .bytes = {0xfd, 0x00, 0x9a}});
    record.add_message({.arrival = {100}, .bytes = {'!', 'P'}, .source = MessageSource::station});
  }
  const std::vector<RecordedSession> sessions = read_sessions(folder);
  ASSERT_EQ(sessions.size(), 1U);
  EXPECT_EQ(sessions[0].codec->codec_id, AV_CODEC_ID_H264);
  EXPECT_EQ(sessions[0].time_base.den, 90'000);
  const std::vector<RecordedPacket> packets = read_packets(folder);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0].pts, 1234);
  EXPECT_EQ(packets[0].size, 3);
  const std::vector<RecordedFrame> frames = read_frames(folder);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].stamp_sigma_s, sigma_s);
  EXPECT_EQ(frames[0].stamp.ns, -8);
  EXPECT_EQ(frames[0].decision.ns, 99);
  EXPECT_EQ(frames[1].outcome, FrameOutcome::settling);
  const std::vector<RecordedMessage> messages = read_messages(folder);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].source, MessageSource::mavlink);
  EXPECT_EQ(messages[1].source, MessageSource::station);
  EXPECT_EQ(messages[0].bytes, (std::vector<std::uint8_t>{0xfd, 0x00, 0x9a}));
  EXPECT_EQ(messages[0].arrival.ns, 99);
}

TEST_F(FlightFiles, RowWithoutLineBreakIsIgnored) {
  { const FlightRecord record(folder); }
  append(kFramesFile, "0,used,1,0.5,0\n1,used,2,0.");
  EXPECT_EQ(read_frames(folder).size(), 1U);
}

TEST_F(FlightFiles, RowsOfEarlierVersionsAreRead) {
  { const FlightRecord record(folder); }
  append(kFramesFile, "0,used,12,0.5,3\n");
  append(kTelemetryFile, "7,fd00\n");
  EXPECT_EQ(read_frames(folder).at(0).decision.ns, 12);
  EXPECT_EQ(read_messages(folder).at(0).source, MessageSource::mavlink);
}

TEST_F(FlightFiles, CommandsFollowThoseOfTheSupervisingProcess) {
  {
    FlightRecord record(folder);
    EXPECT_FALSE(fs::exists(folder / kCommandsFile));
    record.add_command("#header\n");
    append(kCommandsFile, "1,hold\n");
    record.add_command("2,command\n");
  }
  EXPECT_EQ(fs::file_size(folder / kCommandsFile),
            std::string("#header\n1,hold\n2,command\n").size());
}

TEST_F(FlightFiles, DamagedRowIsAnInputError) {
  { const FlightRecord record(folder); }
  append(kFramesFile, "0,used,1,0.5\n");
  append(kPacketsFile, "0,x,1,0,0,0,0\n");
  append(kTelemetryFile, "5,0fz0\n");
  append(kSessionsFile, "no_codec,0,1,1,0,1,1,\n");
  EXPECT_THROW(static_cast<void>(read_frames(folder)), InputError);
  EXPECT_THROW(static_cast<void>(read_packets(folder)), InputError);
  EXPECT_THROW(static_cast<void>(read_messages(folder)), InputError);
  EXPECT_THROW(static_cast<void>(read_sessions(folder)), InputError);
}

TEST_F(FlightFiles, FolderWithAFlightIsAnInputError) {
  { const FlightRecord record(folder); }
  EXPECT_THROW(const FlightRecord record(folder), InputError);
}

TEST_F(FlightFiles, FolderWithOtherFilesIsAnInputErrorAndStaysAsItIs) {
  fs::create_directories(folder);
  append(kEstimatesFile, "1\n");
  EXPECT_THROW(const FlightRecord record(folder), InputError);
  EXPECT_FALSE(fs::exists(folder / kSessionsFile));
}

}  // namespace
}  // namespace stillkite
