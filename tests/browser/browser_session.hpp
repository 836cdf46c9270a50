#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace stillkite {

/// Headless Chromium driven by the DevTools protocol: clicks and key strokes as of a user.
class BrowserSession {
 public:
  /// `scratch`: folder for the browser. Throws std::runtime_error if it does not start.
  BrowserSession(const std::string& browser, const std::filesystem::path& scratch);
  ~BrowserSession();
  BrowserSession(const BrowserSession&) = delete;
  BrowserSession& operator=(const BrowserSession&) = delete;

  /// Opens a tab with a viewport of the given width; the following calls are for it.
  void open(const std::string& url, int width_px);
  /// Selects a tab in the order of opening, from 0.
  void select(std::size_t tab) { tab_ = tab; }

  /// Value of a JavaScript expression in the tab.
  nlohmann::json evaluate(const std::string& expression);
  /// True once the expression is true; false after 20 s.
  [[nodiscard]] bool wait_until(const std::string& expression);
  /// Scrolls to the element and clicks in its middle.
  void click(const std::string& selector);
  /// Types into the focused element.
  void type(const std::string& text);

 private:
  nlohmann::json call(const std::string& method, nlohmann::json parameters, bool in_tab = true);
  nlohmann::json receive();

  pid_t process_ = -1;
  int to_browser_ = -1, from_browser_ = -1;
  std::string received_;
  int last_id_ = 0;
  std::vector<std::string> tabs_;  // sessions of the protocol
  std::size_t tab_ = 0;
};

}  // namespace stillkite
