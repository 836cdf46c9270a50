// ROS recordings in each container, serialization and compression.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "io/config/run_config.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/import/flight_folder.hpp"
#include "io/import/ros_flight.hpp"
#include "tests/io/import/ros_database_sample.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

void expect_ros_sample(const std::filesystem::path& file) {
  const std::optional<RecordingFormat> format = recording_format_of(file);
  ASSERT_TRUE(format);
  const RosFlight ros = read_ros_flight(file, *format, [] {});
  const ImportedFlight& flight = ros.flight;
  EXPECT_EQ(flight.rejected, 0U);
  ASSERT_EQ(flight.angular_rate_in_body_rad_s.values.size(), 10U);
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.stamps[9].ns, 1'090'000'000);
  EXPECT_EQ(flight.angular_rate_in_body_rad_s.values[9], Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(flight.specific_force_in_body_m_s2.values[9], Eigen::Vector3d(0, 0, 9.81));
  ASSERT_EQ(flight.attitude.values.size(), 10U);
  EXPECT_EQ(flight.attitude.values[0].w(), 0.8);
  EXPECT_EQ(flight.attitude.values[0].z(), 0.6);
  ASSERT_EQ(flight.positions.values.size(), 1U);
  EXPECT_EQ(flight.positions.values[0].longitude_deg, 8);
  ASSERT_TRUE(flight.camera);
  EXPECT_EQ(flight.camera->width_px, 16);
  EXPECT_EQ(flight.camera->focal_y_px, 6);
  EXPECT_EQ(flight.camera->coefficients, (std::vector<double>{-0.1, 0.01, 0, 0, 0}));
  EXPECT_EQ(ros.image_topic, "/image");
}

TEST(RosRecordings, Mcap) {
  const TemporaryFolder folder;
  for (const bool is_cdr : {false, true}) {
    for (const char* compression : {"", "lz4", "zstd"}) {
      SCOPED_TRACE(compression);
      expect_ros_sample(folder.file("a.mcap", samples::mcap(is_cdr, compression)));
    }
  }
}

TEST(RosRecordings, Bag) {
  const TemporaryFolder folder;
  for (const char* compression : {"none", "lz4", "bz2"}) {
    SCOPED_TRACE(compression);
    expect_ros_sample(folder.file("a.bag", samples::rosbag(compression)));
  }
}

TEST(RosRecordings, Database) {
  const TemporaryFolder folder;
  samples::write_ros_database(folder.path() / "a.db3");
  expect_ros_sample(folder.path() / "a.db3");
}

TEST(RosRecordings, DamagedChunkIsReported) {
  const TemporaryFolder folder;
  std::string bag = samples::rosbag("bz2");
  bag[bag.size() - 20] ^= 1;
  const RosFlight ros = read_ros_flight(folder.file("a.bag", bag), RecordingFormat::rosbag, [] {});
  ASSERT_EQ(ros.flight.notes.size(), 1U);
  EXPECT_EQ(ros.flight.notes[0].text, "1 damaged or cut off parts");
}

TEST(RosRecordings, OtherDatabaseIsRejected) {
  const TemporaryFolder folder;
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder.path() / "a.db").string().c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "CREATE TABLE x(y)", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_recording({folder.path() / "a.db"}, {}); })
                .substr(0, 40),
            "a.db: a database, but no ROS 2 bag: no s");
}

TEST(RosRecordings, ImagesBecomeAEurocDataset) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "flight";
  const Recording recording =
      read_recording({folder.file("a.mcap", samples::mcap(true, "zstd"))}, {});
  (void)write_flight_folder(recording, {}, out);
  const RunConfig config = load_run_config(out / "flight.yaml", {});
  EXPECT_EQ(config.calibration.camera->focal_x_px, 5);
  EXPECT_FALSE(config.imu.time_offset_s);  // one clock
  const std::optional<EurocDataset> dataset = find_euroc_dataset(config.source.path);
  ASSERT_TRUE(dataset);
  const std::vector<StampedImage> images = read_image_list(dataset->images_csv);
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[1].stamp.ns, 1'010'000'000);
  for (const StampedImage& image : images) {
    const cv::Mat grey = cv::imread(image.file.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(grey.size(), cv::Size(16, 16));
    EXPECT_EQ(grey.type(), CV_8UC1);
    EXPECT_EQ(grey.at<std::uint8_t>(0, 3), 1);
    EXPECT_EQ(grey.at<std::uint8_t>(15, 15), 127);
  }
}

bool has_note(const std::vector<ImportNote>& notes, const char* part) {
  return std::ranges::any_of(
      notes, [&](const ImportNote& note) { return note.text.find(part) != std::string::npos; });
}

// Images of an encoding; without stamps if the seconds are 0.
samples::RosSample image_message(const char* encoding, std::int32_t seconds = 1) {
  return {"/image", "Image",
          samples::RosWriter(true)
              .number(seconds)
              .number(std::uint32_t{0})
              .text("camera")
              .number(std::uint32_t{16})
              .number(std::uint32_t{16})
              .text(encoding)
              .number(std::uint8_t{0})
              .number(std::uint32_t{16})
              .data(std::string(256, 'x'))
              .bytes()};
}

TEST(RosRecordings, LengthBeyondAllFileOffsetsEndsTheReading) {
  const TemporaryFolder folder;
  const std::string bytes = ByteWriter{}
                                .text("\x89MCAP0\r\n")
                                .little(std::uint8_t{0x99})
                                .little(~std::uint64_t{19})
                                .text("", 100)
                                .bytes;
  EXPECT_EQ(
      input_error_of(folder, [&] { (void)read_recording({folder.file("a.mcap", bytes)}, {}); })
          .substr(0, 38),
      "a.mcap: MCAP recording without a readi");
}

TEST(RosRecordings, MessageWithoutStampHasTheTimeOfRecording) {
  const TemporaryFolder folder;
  const Recording recording = read_recording(
      {folder.file("a.mcap", samples::mcap({image_message("mono8", 0)}, true, ""))}, {});
  (void)write_flight_folder(recording, {}, folder.path() / "flight");
  const std::optional<EurocDataset> dataset = find_euroc_dataset(folder.path() / "flight");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(read_image_list(dataset->images_csv).at(0).stamp.ns, 5'000'000'000);
}

TEST(RosRecordings, UnknownEncodingIsNamed) {
  const TemporaryFolder folder;
  const Recording recording = read_recording(
      {folder.file("a.mcap", samples::mcap({image_message("32FC1")}, true, ""))}, {});
  EXPECT_EQ(input_error_of(
                folder, [&] { (void)write_flight_folder(recording, {}, folder.path() / "flight"); })
                .substr(0, 71),
            "a.mcap: cannot read 1 of 1 images of topic /image, encoding '32FC1'; kn");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "flight"));
}

TEST(RosRecordings, ImagesWithoutCameraInfoHaveTheNominalLens) {
  const TemporaryFolder folder;
  const Recording recording = read_recording(
      {folder.file("a.mcap", samples::mcap({image_message("mono8")}, true, ""))}, {});
  (void)write_flight_folder(recording, {}, folder.path() / "flight");
  const RunConfig config = load_run_config(folder.path() / "flight" / "flight.yaml", {});
  ASSERT_TRUE(config.calibration.camera);
  EXPECT_EQ(config.calibration.camera->width_px, 16);
  EXPECT_NEAR(config.calibration.camera->focal_x_px, 8 / std::tan(35 * M_PI / 180), 1e-6);
}

TEST(RosRecordings, CalibrationIsOfTheImagesNamespace) {
  const TemporaryFolder folder;
  std::vector<samples::RosSample> messages = samples::ros_messages(true);
  samples::RosSample info = messages.back();
  messages.clear();
  for (const char* name : {"/left", "/right"}) {
    info.topic = std::string(name) + "/camera_info";
    info.bytes[info.bytes.size() - 56] = name[1] == 'l' ? 1 : 2;  // in the mantissa of K[2]
    messages.push_back(info);
  }
  messages.push_back(image_message("mono8"));
  messages.back().topic = "/right/image_raw";
  const RosFlight ros = read_ros_flight(folder.file("a.mcap", samples::mcap(messages, true, "")),
                                        RecordingFormat::mcap, [] {});
  EXPECT_TRUE(has_note(ros.flight.notes, "CameraInfo: topic /right/camera_info, the best"));
}

TEST(RosRecordings, InitialAttitudeIsThatOfTheFirstReadings) {
  const TemporaryFolder folder;
  std::vector<samples::RosSample> messages{image_message("mono8")};
  for (int i = 0; i < 10; ++i) {
    messages.push_back({"/imu", "Imu",
                        samples::RosWriter(true)
                            .header(i)
                            .numbers({0, 0, 0, 1})
                            .numbers({-1, 0, 0, 0, 0, 0, 0, 0, 0})
                            .numbers({0, 0, 0})
                            .numbers(std::vector<double>(9))
                            .numbers({-9.81 * std::sin(0.1), 0, 9.81 * std::cos(0.1)})
                            .numbers(std::vector<double>(9))
                            .bytes()});
  }
  const Recording recording =
      read_recording({folder.file("a.mcap", samples::mcap(messages, true, ""))}, {});
  (void)write_flight_folder(recording, {}, folder.path() / "flight");
  const RunConfig config = load_run_config(folder.path() / "flight" / "flight.yaml", {});
  EXPECT_NEAR(config.initial.pitch_deg, 0.1 * 180 / M_PI, 0.01);
}

TEST(RosRecordings, InterruptedImportLeavesNoFolder) {
  struct Stop {};
  const TemporaryFolder folder;
  const Recording recording = read_recording({folder.file("a.mcap", samples::mcap(true, ""))}, {});
  int messages = 0;
  const ImportOptions options{.poll = [&] {
    if (++messages == 15) throw Stop{};
  }};
  const std::filesystem::path out = folder.path() / "flight";
  EXPECT_THROW((void)write_flight_folder(recording, options, out), Stop);
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "flight.part"));
}

}  // namespace
}  // namespace stillkite
