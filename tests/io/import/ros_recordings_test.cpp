// ROS recordings in each container, serialization and compression.
#include <gtest/gtest.h>

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
  const RosFlight ros = read_ros_flight(file, *format);
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
  const RosFlight ros = read_ros_flight(folder.file("a.bag", bag), RecordingFormat::rosbag);
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

}  // namespace
}  // namespace stillkite
