// Files to a folder that stillkite run accepts.
#include <gtest/gtest.h>

#include <algorithm>

#include "io/config/run_config.hpp"
#include "io/dataset/sensor_log.hpp"
#include "io/dataset/trajectory_file.hpp"
#include "io/import/flight_folder.hpp"
#include "io/recording_format.hpp"
#include "io/text_file.hpp"
#include "tests/io/import/samples.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

bool has_note(const std::vector<ImportNote>& notes, ImportNote::Kind kind, const char* part) {
  return std::ranges::any_of(notes, [&](const ImportNote& note) {
    return note.kind == kind && note.text.find(part) != std::string::npos;
  });
}

TEST(RecordingFormat, IsRecognizedByContent) {
  EXPECT_EQ(recording_format(samples::ulog()), RecordingFormat::ulog);
  EXPECT_EQ(recording_format(samples::dataflash()), RecordingFormat::dataflash);
  EXPECT_EQ(recording_format(samples::tlog()), RecordingFormat::tlog);
  EXPECT_EQ(recording_format(samples::kSubtitles), RecordingFormat::subtitles);
  EXPECT_EQ(recording_format(std::string_view("\0\0\0\x20"
                                              "ftypmp41\0\0\0\0",
                                              16)),
            RecordingFormat::mp4);
}

TEST(RecordingFormat, LeavesOtherFiles) {
  for (const char* text : {"", "1", "source: {path: a.mp4}", "the wide river", "1,2,3\n4,5,6\n",
                           "1000 0 0 0 0 0 0 1\n", "#timestamp [ns],wx\n1,2\n"}) {
    EXPECT_FALSE(recording_format(text)) << text;
  }
}

TEST(RecordingFormat, ReadersOfOtherFormatsNameTheImport) {
  const TemporaryFolder folder;
  const auto file = folder.file("flight.csv", samples::ulog());
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_text_file(file); }).substr(0, 65),
            "flight.csv: recognized as PX4 log (ULog); convert it: stillkite i");
}

TEST(FlightFolder, IsReadByTheRunsReaders) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "flight";
  const Recording recording = read_recording({folder.file("a.ulg", samples::ulog())}, {});
  const std::vector<ImportNote> notes = write_flight_folder(recording, {}, out);
  EXPECT_TRUE(has_note(notes, ImportNote::Kind::missing, "video"));
  EXPECT_TRUE(has_note(notes, ImportNote::Kind::assumed, "mount"));
  EXPECT_TRUE(has_note(notes, ImportNote::Kind::found, "imu: 10 readings, 100 Hz, 0.1 s"));

  const RunConfig config = load_run_config(out / "flight.yaml", {});
  EXPECT_EQ(config.estimator.policy, Policy::fused);
  EXPECT_EQ(config.mount.down_deg, 90);
  EXPECT_EQ(config.height.source, HeightSource::range);
  EXPECT_EQ(config.imu.time_offset_s, -1);  // the log starts with the video
  EXPECT_EQ(config.truth.time_offset_s, -1);
  const TimeSeries<Vector6d> imu = read_imu(*config.imu.path);
  ASSERT_EQ(imu.values.size(), 10U);
  EXPECT_EQ(imu.stamps[0].ns, 1'000'000'000);
  Vector6d expected;
  expected << 0.1, -0.2, -0.3, 0, 0, 9.80665;
  EXPECT_LT((imu.values[0] - expected).norm(), 1e-5);
  EXPECT_EQ(read_heights(*config.height.path).values.at(0), 5);
  EXPECT_EQ(read_attitudes(*config.attitude.path).values.size(), 10U);
  EXPECT_EQ(read_positions(*config.truth.positions).size(), 10U);
  EXPECT_EQ(read_velocities(*config.truth.velocity).at(0).velocity_in_world_m_s.x(), 2);
}

TEST(FlightFolder, LogStartSetsTheClockOffset) {
  const TemporaryFolder folder;
  const ImportOptions options{.log_start_s = 2.5};
  const Recording recording = read_recording({folder.file("a.tlog", samples::tlog())}, options);
  EXPECT_DOUBLE_EQ(recording.time_offset_s, 1.5);
}

TEST(FlightFolder, HeightOfSubtitlesIsAboveTakeoff) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "flight";
  const Recording recording = read_recording({folder.file("a.SRT", samples::kSubtitles)}, {});
  EXPECT_EQ(recording.time_offset_s, 0);
  (void)write_flight_folder(recording, {}, out);
  const RunConfig config = load_run_config(out / "flight.yaml", {});
  EXPECT_EQ(config.initial.height_m, 5);
  EXPECT_EQ(config.height.source, HeightSource::barometer);
  const std::vector<StampedPose> positions = read_positions(*config.truth.positions);
  EXPECT_NEAR(positions.at(0).world_from_body.translation.z(), 5, 1e-4);
  EXPECT_NEAR(positions.at(1).world_from_body.translation.y(), 1.1118, 1e-3);  // 1e-5 deg
}

TEST(FlightFolder, OmitsATruthFasterThanSound) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "flight";
  const Recording recording = read_recording(
      {folder.file("a.SRT",
                   "1\n00:00:00,000 --> 00:00:00,033\n[latitude: 47.0] [longitude: 8.0]\n\n"
                   "2\n00:00:00,033 --> 00:00:00,066\n[latitude: 47.001] [longitude: 8.0]\n")},
      {});
  const std::vector<ImportNote> notes = write_flight_folder(recording, {}, out);
  EXPECT_TRUE(has_note(notes, ImportNote::Kind::missing, "truth: the GNSS positions move at 3369"));
  EXPECT_FALSE(load_run_config(out / "flight.yaml", {}).truth.positions);
}

TEST(FlightFolder, NamesASensorOnAnotherClock) {
  const TemporaryFolder folder;
  Recording recording = read_recording({folder.file("a.ulg", samples::ulog())}, {});
  for (Timestamp& stamp : recording.flight.positions.stamps) {
    stamp.ns += 1'700'000'000'000'000'000;  // since 1970
  }
  const std::vector<ImportNote> notes =
      write_flight_folder(recording, {}, folder.path() / "flight");
  EXPECT_TRUE(has_note(notes, ImportNote::Kind::missing,
                       "common clock: no reading of GNSS position is at a time of the imu"));
  EXPECT_FALSE(has_note(notes, ImportNote::Kind::missing, "no reading of GNSS velocity"));
}

TEST(FlightFolder, MountIsThatOfTheCalibration) {
  const TemporaryFolder folder;
  const std::string lens =
      "cam0: {camera_model: pinhole, intrinsics: [240, 240, 159.5, 119.5], distortion_model: "
      "radtan,"
      " distortion_coeffs: [0, 0, 0, 0], resolution: [320, 240]";
  const Recording recording = read_recording({folder.file("a.ulg", samples::ulog())}, {});
  const auto imported = [&](const std::string& name, const std::string& calibration) {
    const std::filesystem::path out = folder.path() / name;
    const ImportOptions options{.calibration = folder.file(name + ".yaml", calibration)};
    const std::vector<ImportNote> notes = write_flight_folder(recording, options, out);
    EXPECT_NE(has_note(notes, ImportNote::Kind::assumed, "mount"),
              has_note(notes, ImportNote::Kind::found, "mount: extrinsics of the calibration"));
    return load_run_config(out / "flight.yaml", {});
  };
  EXPECT_EQ(imported("without", lens + "}").mount.down_deg, 90);
  const std::string extrinsics =
      ", T_cam_imu: [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]}";
  EXPECT_FALSE(imported("with", lens + extrinsics).mount.down_deg);
}

TEST(FlightFolder, CalibrationOfAnotherResolutionIsRejected) {
  const TemporaryFolder folder;
  const auto calibration = folder.file("lens.yaml",
                                       "cam0: {camera_model: pinhole, intrinsics: [240, 240, "
                                       "159.5, 119.5], distortion_model: radtan,"
                                       " distortion_coeffs: [0, 0, 0, 0], resolution: [320, 240]}");
  Recording recording = read_recording({folder.file("a.ulg", samples::ulog())}, {});
  recording.video = ImportedVideo{.file = "a.mp4", .width_px = 640, .height_px = 480};
  EXPECT_EQ(input_error_of(folder,
                           [&] {
                             (void)write_flight_folder(recording, {.calibration = calibration},
                                                       folder.path() / "flight");
                           }),
            "lens.yaml: calibration of 320x240 images, but the recording has 640x480; give the "
            "calibration of this resolution");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "flight"));
}

TEST(Recording, NamesTheUnknownAndTheEmptyFile) {
  const TemporaryFolder folder;
  const auto log = folder.file("a.ulg", samples::ulog());
  const auto text = folder.file("c.txt", "hello"), empty = folder.file("d.bin", "");
  const auto error = [&](const std::vector<std::filesystem::path>& files) {
    return input_error_of(folder, [&] { (void)read_recording(files, {}); });
  };
  EXPECT_EQ(error({text, text}).substr(0, 29), "c.txt: unknown format; known:");
  EXPECT_EQ(error({log, empty}), "d.bin: the file is empty; copy it from the device again");
}

TEST(ImportNote, HasNoControlCharacters) {
  std::vector<ImportNote> notes;
  add_note(notes, ImportNote::Kind::found, "device 'a\x1b[2J\n'");
  EXPECT_EQ(notes.at(0).text, "device 'a?[2J?'");
}

TEST(Recording, RejectsTwoLogsAndUnknownFormats) {
  const TemporaryFolder folder;
  const auto first = folder.file("a.ulg", samples::ulog());
  const auto second = folder.file("b.bin", samples::dataflash());
  EXPECT_EQ(input_error_of(folder,
                           [&] {
                             (void)read_recording({first, second}, {});
                           }),
            "a.ulg and b.bin are both logs; import one flight at a time");
  const auto text = folder.file("c.txt", "hello");
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_recording({text}, {}); }).substr(0, 29),
            "c.txt: unknown format; known:");
  const auto empty = folder.file("d.ulg", samples::ulog().substr(0, 16));
  EXPECT_NE(input_error_of(folder, [&] { (void)read_recording({empty}, {}); })
                .find("without a reading of a motion sensor"),
            std::string::npos);
}

}  // namespace
}  // namespace stillkite
