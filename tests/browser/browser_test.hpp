#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <regex>
#include <string>

#include "tests/browser/headless_browser.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {

/// Attribute data-NAME of the root element; nullopt if not set.
inline std::optional<std::string> root_data(const std::string& dom, const std::string& name) {
  std::smatch found;
  const std::regex pattern("<html[^>]* data-" + name + "=\"([^\"]*)\"");
  if (!std::regex_search(dom, found, pattern)) return std::nullopt;
  return found[1];
}

inline int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Renders pages in an installed browser; skipped without one.
class BrowserTest : public testing::Test {
 protected:
  void SetUp() override {
    browser_ = find_browser();
    if (!browser_) GTEST_SKIP() << "no chromium installed";
  }

  std::string show(const std::string& html) {
    const auto page = folder_.path() / "report.html";
    std::ofstream(page) << html;
    return rendered(*browser_, page, folder_.path());
  }

  std::optional<std::string> browser_;
  TemporaryFolder folder_;
};

}  // namespace stillkite
