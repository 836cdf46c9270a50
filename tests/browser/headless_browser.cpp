#include "tests/browser/headless_browser.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace stillkite {

std::optional<std::string> find_browser() {
  for (const std::string name : {"chromium", "chromium-browser", "google-chrome"}) {
    if (std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0) return name;
  }
  return std::nullopt;
}

std::string rendered(const std::string& browser, const std::filesystem::path& page,
                     const std::filesystem::path& scratch) {
  const std::filesystem::path dump = scratch / "dom.html";
  const std::string command =
      "timeout 120 " + browser +
      " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run"
      " --disable-background-networking --disable-component-update --disable-sync"
      " --window-size=1280,2600 --user-data-dir='" +
      (scratch / "profile").string() + "' --dump-dom 'file://" + page.string() + "' >'" +
      dump.string() + "' 2>/dev/null";
  if (std::system(command.c_str()) != 0) return {};
  std::ifstream file(dump);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace stillkite
