#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/house/floor_plan.hpp"

namespace stillkite::house {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = STILLKITE_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool is_source(const fs::path& file) {
  return file.extension() == ".hpp" || file.extension() == ".cpp";
}

FloorPlan project_floor_plan() {
  return parse_floor_plan(text_of(kRoot / "docs/architecture.md"));
}

TEST(Layers, EveryIncludeObeysTheFloorPlan) {
  const FloorPlan plan = project_floor_plan();
  int sources = 0;
  for (const auto& [folder, floor] : plan) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (!is_source(entry.path())) continue;
      ++sources;
      for (const std::string& violation : forbidden_includes(plan, folder, text_of(entry.path()))) {
        ADD_FAILURE() << fs::relative(entry.path(), kRoot).string() << " " << violation;
      }
    }
  }
  EXPECT_GT(sources, 0);
}

// Wing of a file: "two_view" for estimation/two_view/homography.cpp, "" for estimation/verdict.hpp.
std::string wing_of(const fs::path& file, const std::string& folder) {
  const fs::path inside = fs::relative(file, kRoot / folder);
  return inside.has_parent_path() ? inside.begin()->string() : "";
}

TEST(Layers, EveryIncludeBetweenWingsObeysTheWingPlan) {
  const FloorPlan plan = project_floor_plan();
  const WingPlan wings = parse_wing_plan(text_of(kRoot / "docs/architecture.md"));
  ASSERT_TRUE(wings.contains("estimation/two_view"));
  for (const auto& [folder, floor] : plan) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (!is_source(entry.path())) continue;
      const std::string wing = wing_of(entry.path(), folder);
      EXPECT_TRUE(wing.empty() || wings.contains(std::string(folder).append("/").append(wing)))
          << folder << "/" << wing << "/ is missing in docs/architecture.md";
      for (const std::string& violation :
           forbidden_wing_includes(wings, folder, wing, text_of(entry.path()))) {
        ADD_FAILURE() << fs::relative(entry.path(), kRoot).string() << " " << violation;
      }
    }
  }
}

TEST(Layers, WingMayIncludeItselfItsFolderAndListedWings) {
  const WingPlan plan = parse_wing_plan(
      "| wing | contents | may include |\n"
      "| `numbers/sums/` | sums | |\n"
      "| `numbers/means/` | means | `sums/` |\n");
  const auto violations = [&](const std::string& wing, const std::string& include) {
    return forbidden_wing_includes(plan, "numbers", wing, "#include \"" + include + "\"\n").size();
  };
  EXPECT_EQ(violations("means", "numbers/sums/a.hpp"), 0U);
  EXPECT_EQ(violations("means", "numbers/means/a.hpp"), 0U);
  EXPECT_EQ(violations("means", "numbers/a.hpp"), 0U);
  EXPECT_EQ(violations("sums", "numbers/means/a.hpp"), 1U);
  EXPECT_EQ(violations("", "numbers/sums/a.hpp"), 1U);
}

TEST(Layers, EveryLibraryFolderIsInTheFloorPlan) {
  const FloorPlan plan = project_floor_plan();
  for (const fs::directory_entry& entry : fs::directory_iterator(kRoot)) {
    const std::string folder = entry.path().filename();
    if (folder == "tests" || folder == "bench" || folder == "examples" || folder == "packaging" ||
        !fs::exists(entry.path() / "CMakeLists.txt")) {
      continue;
    }
    EXPECT_TRUE(plan.contains(folder)) << folder << "/ is missing in docs/architecture.md";
  }
}

class FloorPlanRules : public testing::Test {
 protected:
  const FloorPlan plan = parse_floor_plan(
      "| floor | folder | its one job | may include |\n"
      "|---|---|---|---|\n"
      "| 2 | `top/` | all | everything |\n"
      "| 1 | `left/` | images | `Eigen/`, `opencv2/core` |\n"
      "| 1 | `right/` | numbers | `Eigen/` |\n"
      "| 0 | `ground/` | values | |\n");

  [[nodiscard]] std::vector<std::string> violations(const std::string& folder,
                                                    const std::string& include) const {
    return forbidden_includes(plan, folder, "// a comment\n#include " + include + "\n");
  }
};

TEST_F(FloorPlanRules, ParsesLevelsAndLibraries) {
  ASSERT_EQ(plan.size(), 4U);
  EXPECT_EQ(plan.at("left").level, 1);
  EXPECT_EQ(plan.at("left").library_prefixes, (std::vector<std::string>{"Eigen/", "opencv2/core"}));
  EXPECT_TRUE(plan.at("top").includes_everything);
  EXPECT_FALSE(plan.at("ground").includes_everything);
}

TEST_F(FloorPlanRules, PermitsLowerFloorsOwnFolderAndStandardLibrary) {
  EXPECT_TRUE(violations("left", "\"ground/a.hpp\"").empty());
  EXPECT_TRUE(violations("left", "\"left/a.hpp\"").empty());
  EXPECT_TRUE(violations("ground", "<vector>").empty());
  EXPECT_TRUE(violations("ground", "<unistd.h>").empty());
}

TEST_F(FloorPlanRules, ForbidsHigherAndSameFloor) {
  EXPECT_EQ(violations("ground", "\"left/a.hpp\""),
            std::vector<std::string>{"line 2: left/a.hpp is on a higher floor"});
  EXPECT_EQ(violations("left", "\"right/a.hpp\""),
            std::vector<std::string>{"line 2: right/a.hpp is on the same floor"});
  EXPECT_EQ(violations("left", "\"cellar/a.hpp\"").size(), 1U);
}

TEST_F(FloorPlanRules, ForbidsUnlistedLibraries) {
  EXPECT_TRUE(violations("left", "<opencv2/core/mat.hpp>").empty());
  EXPECT_TRUE(violations("top", "<yaml-cpp/yaml.h>").empty());
  EXPECT_EQ(violations("left", "<opencv2/video.hpp>"),
            std::vector<std::string>{"line 2: opencv2/video.hpp is not permitted on this floor"});
  EXPECT_EQ(violations("right", "<opencv2/core.hpp>").size(), 1U);
  EXPECT_EQ(violations("ground", "<Eigen/Core>").size(), 1U);
}

}  // namespace
}  // namespace stillkite::house
