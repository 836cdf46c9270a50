// Fuzz test of the importers: truncations, byte flips and splices of recordings of each format,
// fixed seed, bounded time. Each is read or rejected with an InputError, and holds valid readings.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <random>

#include "io/import/dataflash.hpp"
#include "io/import/dji_subtitles.hpp"
#include "io/import/gopro_telemetry.hpp"
#include "io/import/ros_flight.hpp"
#include "io/import/telemetry_log.hpp"
#include "io/import/ulog.hpp"
#include "io/import/video_telemetry.hpp"
#include "io/recording_format.hpp"
#include "tests/io/import/reading_checks.hpp"
#include "tests/io/import/ros_database_sample.hpp"
#include "tests/io/import/samples.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

using Clock = std::chrono::steady_clock;
using Reader = std::function<ImportedFlight(const std::filesystem::path&)>;

// Duration of each format's test; STILLKITE_FUZZ_S replaces it for longer runs.
std::chrono::milliseconds duration() {
  const char* seconds = std::getenv("STILLKITE_FUZZ_S");
  return std::chrono::milliseconds(seconds == nullptr ? 1500 : 1000 * std::atoi(seconds));
}

class ByteMutator {
 public:
  explicit ByteMutator(unsigned seed) : random_(seed) {}

  std::string operator()(std::string bytes) {
    for (std::size_t changes = 1 + below(8); changes > 0; --changes) change(bytes);
    return bytes;
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  void change(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1);
    switch (below(6)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, below(40));
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size() + 1), below(200)));
        break;
      case 3:  // extreme value of a length or number
        for (std::size_t i = at; i < std::min(bytes.size(), at + 4); ++i) bytes[i] = '\xff';
        break;
      default:
        if (at < bytes.size()) bytes[at] = static_cast<char>(below(256));
    }
  }

  std::mt19937 random_;
};

void expect_only_input_errors(const std::string& good, const Reader& read) {
  const TemporaryFolder folder;
  ByteMutator mutate(20170713);
  int accepted = 0;
  const auto try_read = [&](const std::string& bytes) {
    const auto file = folder.file("recording", bytes);
    (void)recording_format_of(file);
    try {
      ASSERT_EQ(problem_of(read(file)), std::nullopt);
      ++accepted;
    } catch (const InputError& error) {
      ASSERT_GT(std::string(error.what()).size(), 10U);
    }
  };
  try_read(good);
  ASSERT_EQ(accepted, 1);
  const auto end = Clock::now() + duration();
  while (Clock::now() < end && !testing::Test::HasFailure()) try_read(mutate(good));
  EXPECT_GT(accepted, 5);
}

ImportedFlight read_gopro_payloads(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  GoproTelemetry telemetry;
  for (int i = 0; i < 3; ++i) {
    telemetry.add({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                  from_seconds(i), from_seconds(i + 1));
  }
  return telemetry.finish();
}

TEST(ImportMutation, Ulog) {
  expect_only_input_errors(samples::ulog(), read_ulog);
}
TEST(ImportMutation, Dataflash) {
  expect_only_input_errors(samples::dataflash(), read_dataflash);
}
TEST(ImportMutation, TelemetryLog) {
  expect_only_input_errors(samples::tlog(), read_telemetry_log);
}
TEST(ImportMutation, DjiSubtitles) {
  expect_only_input_errors(samples::kSubtitles, read_dji_subtitles);
}
TEST(ImportMutation, GoproPayload) {
  expect_only_input_errors(samples::gopro_payload(), read_gopro_payloads);
}

Reader ros_reader(RecordingFormat format) {
  return [format](const std::filesystem::path& file) {
    const RosFlight ros = read_ros_flight(file, format, [] {});
    const TemporaryFolder images;
    if (ros.image_topic) {
      (void)write_ros_images(file, format, *ros.image_topic, images.path() / "cam0", [] {});
    }
    return ros.flight;
  };
}

TEST(ImportMutation, Mcap) {
  for (const char* compression : {"", "zstd"}) {
    expect_only_input_errors(samples::mcap(true, compression), ros_reader(RecordingFormat::mcap));
  }
}
TEST(ImportMutation, Rosbag) {
  for (const char* compression : {"none", "lz4", "bz2"}) {
    expect_only_input_errors(samples::rosbag(compression), ros_reader(RecordingFormat::rosbag));
  }
}
TEST(ImportMutation, RosDatabase) {
  const TemporaryFolder folder;
  samples::write_ros_database(folder.path() / "a.db3");
  std::ifstream stream(folder.path() / "a.db3", std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  expect_only_input_errors(bytes, ros_reader(RecordingFormat::ros_database));
}

// Real recordings, which lie next to the recordings of STILLKITE_DATA.
std::string real_recording(const char* name) {
  const char* data = std::getenv("STILLKITE_DATA");
  if (data == nullptr || *data == '\0') return {};
  std::ifstream stream(std::filesystem::path(data) / "../cases/logs" / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void fuzz_real(const char* name, const Reader& read) {
  const std::string bytes = real_recording(name);
  if (bytes.empty()) GTEST_SKIP() << name << " is not next to STILLKITE_DATA";
  expect_only_input_errors(bytes, read);
}

TEST(ImportMutation, RealUlog) {
  fuzz_real("px4_small.ulg", read_ulog);
}
TEST(ImportMutation, RealDataflash) {
  fuzz_real("ardupilot_test.bin", read_dataflash);
}
TEST(ImportMutation, RealTelemetryLog) {
  fuzz_real("ardupilot_vtol.tlog", read_telemetry_log);
}
TEST(ImportMutation, RealGoproVideo) {
  fuzz_real("gopro_walk.mp4", [](const std::filesystem::path& file) {
    return read_imported_video(file, true).telemetry.value_or(ImportedFlight{});
  });
}

}  // namespace
}  // namespace stillkite
