// Fuzz test of the readers: random mutations of valid files, fixed seed, bounded time. Every file
// is either read or rejected with an InputError.
#include <chrono>
#include <functional>
#include <random>

#include "io/config/config_binding.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/sensor_log.hpp"
#include "io/dataset/trajectory_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kDurationEach{1200};

constexpr const char* kTokens[] = {
    "nan",  "-inf",    "1e999", "-",    ":",     "[",       "]",  "{",
    "}",    "\n",      ",",     "#",    "%YAML", "---",     "&a", "*a",
    "!!x",  "\"",      "'",     "\\x",  "\t",    "0",       "-1", "1e-320",
    "null", "\r\n",    "${X}",  "?",    "|",     "\xff",    ".",  "99999999999999999999",
    "<<: ", "cam0:\n", " ",     "rows", "cols",  "data: []"};

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string operator()(std::string text) {
    const int changes = below(1, 6);
    for (int i = 0; i < changes; ++i) change(text);
    return text;
  }

 private:
  int below(int low, int high) {
    return std::uniform_int_distribution<int>(low, high - 1)(random_);
  }

  void change(std::string& text) {
    const auto size = static_cast<int>(text.size());
    const auto at = static_cast<std::size_t>(below(0, size + 1));
    const auto length = static_cast<std::size_t>(below(0, 20));
    switch (below(0, 5)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, kTokens[below(0, static_cast<int>(std::size(kTokens)))]);
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(below(0, 256));
        break;
      case 3:
        text.insert(at, text.substr(static_cast<std::size_t>(below(0, size + 1)), 4 * length));
        break;
      default:
        text.resize(at);
    }
  }

  std::mt19937 random_;
};

void expect_only_input_errors(const std::string& good,
                              const std::function<void(const std::string&)>& read) {
  Mutator mutate(20170713);
  int accepted = 0;
  int rejected = 0;
  read(good);
  for (const auto end = Clock::now() + kDurationEach; Clock::now() < end;) {
    const std::string text = mutate(good);
    try {
      read(text);
      ++accepted;
    } catch (const InputError& error) {
      ++rejected;
      ASSERT_GT(std::string(error.what()).size(), 10u);
    } catch (const std::exception& error) {
      FAIL() << "not an InputError: " << error.what() << "\n" << text;
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_GT(rejected, 0);
}

constexpr const char* kCalibration = R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}
distortion_coefficients: !!opencv-matrix {rows: 5, cols: 1, dt: d, data: [0.1, 0.2, 0, 0, 0.3]}
)";
constexpr const char* kSensorYaml =
    R"(T_BS: {cols: 4, rows: 4, data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375]
distortion_model: radial-tangential
distortion_coefficients: [-0.28, 0.07, 0.0002, 1.76e-05]
)";
constexpr const char* kRun = R"(source: {path: a.mp4, start_s: 1.5}
calibration:
  camera: {focal_x_px: 1000, distortion: equidistant, coefficients: [0.1, 0, 0, 0]}
initial:
  height_m: 400
  from_truth: false
estimator: {policy: flow, mode: recommended}
)";

TEST(Mutation, CalibrationReadersThrowOnlyInputErrors) {
  const auto read = [](const std::string& text) {
    const Calibration c = read_calibration(parse_yaml(text, "c.yaml", "/"));
    ASSERT_GT(c.camera.focal_x_px, 0);
    ASSERT_GT(c.camera.width_px, 0);
  };
  expect_only_input_errors(kCalibration, read);
  expect_only_input_errors(kSensorYaml, read);
}

TEST(Mutation, RunConfigThrowsOnlyInputErrors) {
  expect_only_input_errors(kRun, [](const std::string& text) {
    const auto config = bind_config<RunConfig>(parse_yaml(text, "r.yaml", "/"));
    ASSERT_TRUE(!config.initial.height_m || *config.initial.height_m > 0);
  });
}

TEST(Mutation, TableReadersThrowOnlyInputErrors) {
  const TemporaryFolder folder;
  expect_only_input_errors(
      "#timestamp [ns],x,y,z,w,x,y,z\n1000,1,2,3,1,0,0,0\n2000,1,2,3,0,1,0,0\n",
      [&](const std::string& text) {
        for (const StampedPose& pose : read_trajectory(folder.file("data.csv", text))) {
          ASSERT_TRUE(pose.world_from_body.translation.allFinite());
        }
      });
  expect_only_input_errors(
      "t [s],wx,wy,wz\n0.5,1,2,3\n0.6,-1,.5,3e-3\n", [&](const std::string& text) {
        const auto series = read_gyro(folder.file("imu.csv", text));
        ASSERT_TRUE(std::is_sorted(series.stamps.begin(), series.stamps.end()));
      });
}

}  // namespace
}  // namespace stillkite
