#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace stillkite::house {
namespace {

namespace fs = std::filesystem;

const fs::path kProject = STILLKITE_SOURCE_DIR;

// Words without a technical use in this project, and former names. Terms: docs/notation.md.
constexpr std::array<const char*, 34> kRetired{
    "told",          "tells",     "alike",         "lest",         "feign",
    "feigns",        "befell",    "mends",         "off by",       "gone through again",
    "take_turn",     "take_rate", "take_readings", "see_ground",   "see_landmarks",
    "may_be_home",   "is_back",   "is_home",       "told_upright", "those_that_are_numbers",
    "FixtureFinder", "passers",   "HoverInbox",    "OwnMotion",    "what_does_not_cover",
    "turn_to_way",   "kMost",     "kFewest",       "kAlike",       "kKnown",
    "kEnough",       "picture",   "pictures",      "beside"};

// The fused estimator and its documents are replaced as a whole; renamed keys name the old ones.
bool is_exempt(const std::string& file) {
  constexpr std::array kParts{"fusion",
                              "fused",
                              "docs/reports/",
                              "landmark",
                              "io/config/renamed_keys",
                              "CHANGELOG.md",
                              "tests/house/language_test.cpp"};
  return std::ranges::any_of(
      kParts, [&](const char* part) { return file.find(part) != std::string::npos; });
}

bool is_text(const fs::path& file) {
  constexpr std::array kExtensions{".hpp", ".cpp", ".md", ".py", ".js", ".html", ".yaml", ".sh"};
  return std::ranges::any_of(kExtensions,
                             [&](const char* extension) { return file.extension() == extension; });
}

const std::regex& retired_words() {
  static const std::regex words = [] {
    std::string pattern;
    for (const char* word : kRetired) pattern.append(pattern.empty() ? "" : "|").append(word);
    return std::regex("\\b(" + pattern + ")\\b", std::regex::icase | std::regex::optimize);
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
  int files = 0;
  for (const char* folder : {"app", "bench", "configs", "docs", "estimation", "evaluation",
                             "examples", "flow", "geometry", "io", "navigation", "scripts",
                             "simulation", "stabilization", "stillkite", "tests"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kProject / folder)) {
      const std::string name = fs::relative(entry.path(), kProject).string();
      if (!entry.is_regular_file() || !is_text(entry.path()) || is_exempt(name)) continue;
      ++files;
      std::ifstream text(entry.path());
      for (const std::string& word : retired_words_in(text, name)) ADD_FAILURE() << word;
    }
  }
  EXPECT_GT(files, 300);
}

TEST(Language, FindsARetiredWordAtItsLine) {
  std::istringstream text("The height is measured.\nThe height is told.\n");
  EXPECT_EQ(retired_words_in(text, "a.md"), std::vector<std::string>{"a.md:2: told"});
}

TEST(Language, AcceptsWordsThatContainARetiredWord) {
  std::istringstream text("one-off bytes, a swordtold, kMostly\n");
  EXPECT_TRUE(retired_words_in(text, "a.md").empty());
}

}  // namespace
}  // namespace stillkite::house
