// Headers of an installation: the public one and what it includes, without a type of OpenCV.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace stillkite::house {
namespace {

const std::filesystem::path kSources = STILLKITE_SOURCE_DIR;
constexpr const char* kPublicHeader = "stillkite/stillkite.hpp";

std::string read(const std::string& file) {
  std::ifstream stream(kSources / file);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), {}};
}

// First group of each match.
std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) {
    found.insert((*i)[1]);
  }
  return found;
}

// In addition to the public header.
std::set<std::string> installed_headers() {
  return matches(read("cmake/stillkite_install.cmake"), std::regex(R"(\n  ([a-z0-9_/]+\.hpp))"));
}

// `text` without comments and string literals.
std::string code_of(const std::string& text) {
  return std::regex_replace(text, std::regex(R"(//[^\n]*|"[^"\n]*")"), "");
}

TEST(InstallList, IsWhatThePublicHeaderIncludes) {
  std::set<std::string> reached;
  for (std::vector<std::string> open{kPublicHeader}; !open.empty();) {
    const std::string text = read(open.back());
    open.pop_back();
    for (const std::string& header : matches(text, std::regex(R"re(#include "([^"]+)")re"))) {
      if (reached.insert(header).second) open.push_back(header);
    }
  }
  EXPECT_GT(reached.size(), 10U);
  EXPECT_EQ(installed_headers(), reached);
}

TEST(InstallList, HasNoTypeOfOpenCv) {
  const std::regex opencv("#include <(opencv2[^>]*)>|\\b(cv::|CV_)|namespace cv\\b");
  EXPECT_TRUE(std::regex_search(code_of("void f(cv::Mat image);"), opencv));
  EXPECT_TRUE(std::regex_search(code_of("#include <opencv2/core.hpp>"), opencv));
  EXPECT_FALSE(std::regex_search(code_of("int i;  // a cv::Mat"), opencv));
  for (const std::string& header : installed_headers()) {
    EXPECT_FALSE(std::regex_search(code_of(read(header)), opencv)) << header;
  }
}

}  // namespace
}  // namespace stillkite::house
