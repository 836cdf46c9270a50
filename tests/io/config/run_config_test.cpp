#include "io/config/run_config.hpp"

#include <fmt/core.h>

#include "io/config/config_printing.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

// Dotted paths of all keys, absent groups included.
void list_keys(const ConfigNode& node, const std::string& prefix, std::vector<std::string>& keys) {
  for (const auto& [name, value] : node.entries) {
    if (value.kind == ConfigNode::Kind::map) {
      list_keys(value, prefix + name + ".", keys);
    } else {
      keys.push_back(prefix + name);
    }
  }
}

// Configuration with a value for every key, optional ones included.
ConfigNode full_config() {
  RunConfig config;
  config.source = {.path = "/v.mp4", .start_s = 1, .end_s = 2, .rate_hz = 30};
  config.calibration = {.path = "/c.yaml", .camera = CameraConfig{}};
  config.mount = {.down_deg = 45, .rotation_wxyz = std::array<double, 4>{1, 0, 0, 0}};
  config.truth = {.path = "/t", .positions = "/p", .velocity = "/v"};
  config.initial.height_m = 400;
  config.height = {.source = HeightSource::range, .path = "/h.csv"};
  config.shadow.enabled = true;
  config.gyro.path = config.imu.path = config.attitude.path = config.acceleration.path = "/s.csv";
  return parse_yaml(print_config(config), "full.yaml", "/");
}

TEST(RunConfig, EveryKeyIsReadAndPrinted) {
  const ConfigNode root = full_config();
  const std::string printed = print_config(bind_config<RunConfig>(root));
  EXPECT_EQ(printed, print_config(bind_config<RunConfig>(parse_yaml(printed, "again.yaml", "/"))));
  std::vector<std::string> keys;
  list_keys(root, "", keys);
  EXPECT_GT(keys.size(), 45u);
}

TEST(RunConfig, SuggestsTheKeyForEveryMisspelling) {
  std::vector<std::string> keys;
  list_keys(full_config(), "", keys);
  for (const std::string& key : keys) {
    try {
      (void)load_run_config(std::nullopt, {key + "x=1"});
      ADD_FAILURE() << key << "x was accepted";
    } catch (const InputError& error) {
      const std::string name = key.substr(key.rfind('.') + 1);
      EXPECT_NE(std::string(error.what()).find(key + "x: unknown key"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("did you mean '" + name + "'"), std::string::npos)
          << error.what();
    }
  }
}

// Except for paths, which accept any text.
TEST(RunConfig, EveryKeyRejectsAnInvalidValue) {
  std::vector<std::string> keys;
  list_keys(full_config(), "", keys);
  for (const std::string& key : keys) {
    if (key.ends_with("path") || key == "truth.positions" || key == "truth.velocity") continue;
    EXPECT_THROW((void)load_run_config(std::nullopt, {key + "=nonsense"}), InputError) << key;
  }
}

TEST(RunConfig, ResolvesPathsRelativeToTheFileOrTheCurrentFolder) {
  const TemporaryFolder folder;
  const auto file = folder.file("sub/a.yaml", "source: {path: v.mp4}\ntruth: {path: ../t.tum}\n");
  const RunConfig config = load_run_config(file, {"height.path=h.csv"});
  EXPECT_EQ(config.source.path, folder.path() / "sub/v.mp4");
  EXPECT_EQ(config.truth.path, folder.path() / "t.tum");
  EXPECT_EQ(config.height.path, std::filesystem::current_path() / "h.csv");
}

TEST(RunConfig, EnablesShadowControllerByPolicyUnlessSet) {
  const auto has_shadow = [](const std::vector<std::string>& overrides) {
    return load_run_config(std::nullopt, overrides).has_shadow();
  };
  EXPECT_FALSE(has_shadow({}));
  EXPECT_TRUE(has_shadow({"estimator.policy=reference"}));
  EXPECT_TRUE(has_shadow({"shadow.enabled=true"}));
  EXPECT_FALSE(has_shadow({"estimator.policy=reference", "shadow.enabled=false"}));
}

// Their squares or inverses would overflow or underflow in the filter.
TEST(RunConfig, RejectsNumericallyExtremeSigmas) {
  for (const char* key :
       {"navigator.filter.acceleration_density", "navigator.filter.angular_acceleration_density",
        "navigator.alignment.solver.outlier_sigma", "navigator.paper.filter.velocity_sigma_m_s",
        "navigator.sensors.height_sigma_m", "navigator.sensors.start_height_sigma_ratio",
        "fusion.gyro_density", "fusion.scale_sigma_ratio"}) {
    for (const char* value : {"=1e300", "=1e-300"}) {
      EXPECT_THROW((void)load_run_config(std::nullopt, {key + std::string(value)}), InputError)
          << key << value;
    }
  }
  for (const char* key :
       {"fusion.gyro_bias_walk", "navigator.paper.filter.velocity_process_sigma_m_s"}) {
    EXPECT_THROW((void)load_run_config(std::nullopt, {key + std::string("=1e300")}), InputError);
    EXPECT_NO_THROW((void)load_run_config(std::nullopt, {key + std::string("=0")}));
  }
}

}  // namespace
}  // namespace stillkite
