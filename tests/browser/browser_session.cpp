#include "tests/browser/browser_session.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <stdexcept>
#include <thread>

namespace stillkite {

using nlohmann::json;

BrowserSession::BrowserSession(const std::string& browser, const std::filesystem::path& scratch) {
  std::array<int, 2> down{}, up{};
  if (pipe2(down.data(), O_CLOEXEC) != 0 || pipe2(up.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  const std::string profile = "--user-data-dir=" + (scratch / "session").string();
  process_ = fork();
  if (process_ == 0) {
    setpgid(0, 0);
    // the protocol reads from 3 and writes to 4
    const int input = fcntl(down[0], F_DUPFD, 10), output = fcntl(up[1], F_DUPFD, 10);
    dup2(input, 3);
    dup2(output, 4);
    const int null = ::open("/dev/null", O_RDWR);
    dup2(null, STDERR_FILENO);
    execlp(browser.c_str(), browser.c_str(), "--headless", "--no-sandbox", "--disable-gpu",
           "--no-first-run", "--disable-background-networking", "--disable-component-update",
           "--disable-sync", "--remote-debugging-pipe", profile.c_str(), nullptr);
    _exit(127);
  }
  close(down[0]);
  close(up[1]);
  to_browser_ = down[1];
  from_browser_ = up[0];
}

BrowserSession::~BrowserSession() {
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  close(to_browser_);
  close(from_browser_);
}

json BrowserSession::receive() {
  constexpr int kTimeout_ms = 30'000;
  std::size_t end = received_.find('\0');
  while (end == std::string::npos) {
    pollfd ready{.fd = from_browser_, .events = POLLIN, .revents = 0};
    std::array<char, 65536> bytes{};
    const ssize_t size =
        poll(&ready, 1, kTimeout_ms) > 0 ? read(from_browser_, bytes.data(), bytes.size()) : 0;
    if (size <= 0) throw std::runtime_error("the browser does not answer");
    received_.append(bytes.data(), static_cast<std::size_t>(size));
    end = received_.find('\0');
  }
  const json message = json::parse(received_.substr(0, end));
  received_.erase(0, end + 1);
  return message;
}

json BrowserSession::call(const std::string& method, json parameters, bool in_tab) {
  json message{{"id", ++last_id_}, {"method", method}, {"params", std::move(parameters)}};
  if (in_tab) message["sessionId"] = tabs_.at(tab_);
  const std::string text = message.dump() + '\0';
  if (write(to_browser_, text.data(), text.size()) != std::ssize(text)) {
    throw std::runtime_error("the browser has ended");
  }
  while (true) {
    const json answer = receive();
    if (answer.value("id", 0) != last_id_) continue;  // an event
    if (answer.contains("error")) throw std::runtime_error(method + answer["error"].dump());
    return answer.at("result");
  }
}

void BrowserSession::open(const std::string& url, int width_px) {
  constexpr int kHeight_px = 900;
  const json target = call("Target.createTarget", {{"url", "about:blank"}}, false);
  const json session = call("Target.attachToTarget",
                            {{"targetId", target.at("targetId")}, {"flatten", true}}, false);
  tabs_.push_back(session.at("sessionId"));
  tab_ = tabs_.size() - 1;
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width_px}, {"height", kHeight_px}, {"deviceScaleFactor", 1}, {"mobile", false}});
  call("Page.navigate", {{"url", url}});
}

json BrowserSession::evaluate(const std::string& expression) {
  const json result =
      call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}});
  return result.at("result").value("value", json(nullptr));
}

bool BrowserSession::wait_until(const std::string& expression) {
  constexpr std::chrono::milliseconds kStep{50};
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    if (evaluate(expression) == true) return true;
    std::this_thread::sleep_for(kStep);
  }
  return false;
}

void BrowserSession::click(const std::string& selector) {
  const json at = evaluate("(() => { const e = document.querySelector('" + selector +
                           "'); e.scrollIntoView({block: 'center'}); const r = "
                           "e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height "
                           "/ 2]; })()");
  for (const char* kind : {"mousePressed", "mouseReleased"}) {
    call("Input.dispatchMouseEvent",
         {{"type", kind}, {"x", at.at(0)}, {"y", at.at(1)}, {"button", "left"}, {"clickCount", 1}});
  }
}

void BrowserSession::type(const std::string& text) {
  call("Input.insertText", {{"text", text}});
}

}  // namespace stillkite
