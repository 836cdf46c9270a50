#include "io/config/renamed_keys.hpp"

#include <gtest/gtest.h>

#include "geometry/fields.hpp"
#include "io/config/config_binding.hpp"
#include "io/config/run_config.hpp"

namespace stillkite {
namespace {

TEST(RenamedKeys, OldNameSetsTheNewKeyWithANotice) {
  ConfigNode root = parse_yaml("reference:\n  seek_home_every_frames: 7\n", "old.yaml", "/");
  const std::vector<std::string> notices = move_renamed_keys(root, "", false);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices.front(),
            "old.yaml:2:3: key 'reference.seek_home_every_frames' is now "
            "'reference.relocalize_every_frames'");
  EXPECT_EQ(bind_config<RunConfig>(root).navigator.reference.relocalize_every_frames, 7);
}

TEST(RenamedKeys, OldNameOnTheCommandLineReplacesTheFilesValue) {
  const RunConfig config = load_run_config(
      std::nullopt, {"reference.relocalize_every_frames=3", "reference.seek_home_every_frames=5"});
  EXPECT_EQ(config.navigator.reference.relocalize_every_frames, 5);
}

TEST(RenamedKeys, RejectsAFileThatGivesBothNames) {
  ConfigNode root = parse_yaml(
      "reference: {relocalize_every_frames: 3, seek_home_every_frames: 7}\n", "old.yaml", "/");
  EXPECT_THROW((void)move_renamed_keys(root, "", false), InputError);
}

TEST(RenamedKeys, ASectionFileUsesTheKeysOfItsSection) {
  ConfigNode plant = parse_yaml("station: {upright_reach_m: 0.5}\n", "plant.yaml", "/");
  EXPECT_EQ(move_renamed_keys(plant, "plant.", false).size(), 1U);
  ASSERT_NE(plant.find("station")->find("vertical_reach_m"), nullptr);
  EXPECT_EQ(plant.find("station")->find("upright_reach_m"), nullptr);
}

TEST(RenamedKeys, LeavesOtherKeysAlone) {
  ConfigNode root = parse_yaml("source: {path: flight.mp4}\n", "new.yaml", "/");
  EXPECT_TRUE(move_renamed_keys(root, "", false).empty());
  EXPECT_EQ(root.entries.size(), 1U);
}

TEST(RemovedKeys, ConstantValueIsDroppedWithANotice) {
  ConfigNode root = parse_yaml("reference:\n  pose:\n    min_pairs: 12\n", "old.yaml", "/");
  const std::vector<std::string> notices = drop_removed_keys(root, "");
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices.front(),
            "old.yaml:3:5: key 'reference.pose.min_pairs' was removed; its value is always 12");
  EXPECT_NO_THROW((void)bind_config<RunConfig>(root));
}

TEST(RemovedKeys, AnotherValueIsAnErrorThatNamesTheKey) {
  try {
    (void)load_run_config(std::nullopt, {"reference.pose.refine=false"});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--set reference.pose.refine=false: key 'reference.pose.refine' was removed; its "
                 "value is always true; remove the key");
  }
}

TEST(RemovedKeys, SuccessorIsNamed) {
  ConfigNode root =
      parse_yaml("navigator: {levelling: {flow_sigma_rad: 1e-05}}\n", "old.yaml", "/");
  const std::vector<std::string> notices = drop_removed_keys(root, "");
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices.front(),
            "old.yaml:1:25: key 'navigator.levelling.flow_sigma_rad' was removed; use "
            "navigator.lens_sigma_px");
}

TEST(RemovedKeys, ASectionFileHasNoneOfOtherSections) {
  ConfigNode plant = parse_yaml("reference: {pose: {refine: false}}\n", "plant.yaml", "/");
  EXPECT_TRUE(drop_removed_keys(plant, "plant.").empty());
}

}  // namespace
}  // namespace stillkite
