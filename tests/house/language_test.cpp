#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace stillkite::house {
namespace {

namespace fs = std::filesystem;

const fs::path kProject = STILLKITE_SOURCE_DIR;

// Words without a technical use in this project, and former names. Terms: docs/notation.md.
constexpr std::array kRetired{"told",
                              "tells",
                              "alike",
                              "lest",
                              "feigns?",
                              "befell",
                              "mends",
                              "off by",
                              "pictures?",
                              "gone through again",
                              "take_turn",
                              "take_rate",
                              "is_back",
                              "is_home",
                              "take_readings",
                              "see_ground",
                              "see_landmarks",
                              "told_upright",
                              "may_be_home",
                              "those_that_are_numbers",
                              "passers",
                              "FixtureFinder",
                              "HoverInbox",
                              "OwnMotion",
                              "what_does_not_cover",
                              "turn_to_way",
                              "beside",
                              "k(?:Most|Fewest|Alike|Known|Enough)\\w*"};

// A folder ends with a slash. The fused estimator and its documents are replaced as a whole; two
// files name former keys.
constexpr std::array kExempt{"CHANGELOG.md",
                             "docs/fusion.md",
                             "docs/fusion_honesty.md",
                             "estimation/fusion/",
                             "io/config/renamed_keys.cpp",
                             "navigation/fused_navigator.cpp",
                             "navigation/fused_navigator.hpp",
                             "navigation/fused_velocity.cpp",
                             "navigation/fused_velocity.hpp",
                             "navigation/landmark_selection.cpp",
                             "tests/estimation/fusion/",
                             "tests/house/language_test.cpp",
                             "tests/navigation/fused_navigator_test.cpp",
                             "tests/navigation/fused_over_ground_test.cpp"};

bool covers(std::string_view exempt, std::string_view file) {
  return exempt.ends_with('/') ? file.starts_with(exempt) : file == exempt;
}

bool is_exempt(std::string_view file) {
  return std::ranges::any_of(kExempt, [&](const char* exempt) { return covers(exempt, file); });
}

// Empty outside a repository.
std::vector<std::string> tracked_files() {
  std::vector<std::string> files;
  const std::string command = "git -C '" + kProject.string() + "' ls-files 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "r"), pclose);
  std::array<char, 4096> line{};
  while (output && std::fgets(line.data(), line.size(), output.get())) {
    files.emplace_back(line.data(), std::strcspn(line.data(), "\n"));
  }
  return files;
}

// Without build and result folders.
std::vector<std::string> files_in_tree() {
  constexpr std::array kOutputs{".cache", ".git", "__pycache__", "out"};
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator it(kProject), end; it != end; ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() &&
        (std::ranges::find(kOutputs, name) != kOutputs.end() || name.starts_with("build") ||
         fs::exists(it->path() / "CMakeCache.txt"))) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(it->path().lexically_relative(kProject).string());
    }
  }
  return files;
}

std::vector<std::string> project_files() {
  std::vector<std::string> files = tracked_files();
  return files.empty() ? files_in_tree() : files;
}

// Empty for a binary file and for one that is no longer there.
std::istringstream text_of(const std::string& name) {
  std::ifstream file(kProject / name, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  return std::istringstream(bytes.find('\0') == std::string::npos ? bytes : std::string());
}

const std::regex& retired_words() {
  static const std::regex words = [] {
    std::string pattern;
    for (const char* word : kRetired) pattern.append(pattern.empty() ? "" : "|").append(word);
    return std::regex("\\b(?:" + pattern + ")\\b", std::regex::icase | std::regex::optimize);
  }();
  return words;
}

// "file:line: word" for each retired word of a text.
std::vector<std::string> retired_words_in(std::istream& text, const std::string& name) {
  std::vector<std::string> found;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, retired_words())) {
      found.push_back(name + ":" + std::to_string(number) + ": " + match.str());
    }
  }
  return found;
}

TEST(Language, NoFileUsesARetiredWord) {
  for (const std::string& name : project_files()) {
    if (is_exempt(name)) continue;
    std::istringstream text = text_of(name);
    for (const std::string& word : retired_words_in(text, name)) ADD_FAILURE() << word;
  }
}

TEST(Language, NoFileHasAMergeConflict) {
  for (const std::string& name : project_files()) {
    std::istringstream text = text_of(name);
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
      const bool conflict = line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ");
      EXPECT_FALSE(conflict) << name << ":" << number;
    }
  }
}

TEST(Language, ReadsEveryKindOfFile) {
  for (const std::vector<std::string>& files : {project_files(), files_in_tree()}) {
    EXPECT_GT(files.size(), 900u);
    for (const char* name :
         {".ci/run", "CMakeLists.txt", "CONTRIBUTING.md", "README.md", "bench/real_suite",
          "cmake/stillkite_module.cmake", "io/report/report.css", "scripts/common.sh",
          "scripts/golden", "tests/golden/lens.json"}) {
      EXPECT_EQ(std::ranges::count(files, name), 1) << name;
      EXPECT_FALSE(text_of(name).str().empty()) << name;
    }
  }
}

TEST(Language, EveryExemptPathHasARetiredWord) {
  const std::vector<std::string> files = project_files();
  for (const char* exempt : kExempt) {
    EXPECT_TRUE(std::ranges::any_of(files, [&](const std::string& name) {
      if (!covers(exempt, name)) return false;
      std::istringstream text = text_of(name);
      return !retired_words_in(text, name).empty();
    })) << exempt;
  }
}

TEST(Language, FindsARetiredWordAtItsLine) {
  std::istringstream text("The height is measured.\nThe height is told.\n");
  EXPECT_EQ(retired_words_in(text, "a.md"), std::vector<std::string>{"a.md:2: told"});
}

TEST(Language, FindsANameThatBeginsWithARetiredOne) {
  std::istringstream text("constexpr int kMostPairs = 3;\n");
  EXPECT_EQ(retired_words_in(text, "a.cpp"), std::vector<std::string>{"a.cpp:1: kMostPairs"});
}

TEST(Language, AcceptsWordsThatContainARetiredWord) {
  std::istringstream text("one-off bytes, a swordtold, bookMost\n");
  EXPECT_TRUE(retired_words_in(text, "a.md").empty());
}

}  // namespace
}  // namespace stillkite::house
