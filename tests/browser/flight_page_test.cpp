#include "app/flight_page.hpp"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <thread>

#include "live/clock/local_clock.hpp"
#include "tests/app/page_snapshot_sample.hpp"
#include "tests/browser/browser_session.hpp"
#include "tests/browser/browser_test.hpp"

namespace stillkite {
namespace {

// Page of a flight whose estimates are made here, 20 per second.
class SyntheticFlightPage {
 public:
  using Change = std::function<void(PageSnapshot&, FlightStatus&)>;

  explicit SyntheticFlightPage(Change change = {}, int port = 0)
      : change_(std::move(change)),
        page_({.listen = "127.0.0.1:" + std::to_string(port)}, &operators, log,
              [this](const std::string& line) { log.add(local_now(), line); }),
        thread_([this] { publish_all(); }) {}
  ~SyntheticFlightPage() {
    is_ended_ = true;
    thread_.join();
  }
  SyntheticFlightPage(const SyntheticFlightPage&) = delete;
  SyntheticFlightPage& operator=(const SyntheticFlightPage&) = delete;

  [[nodiscard]] int port() const { return page_.port(); }
  [[nodiscard]] std::string url() const {
    return "http://127.0.0.1:" + std::to_string(port()) + "/";
  }
  // Commands that have arrived, after waiting for one.
  [[nodiscard]] std::vector<OperatorCommand> commands() {
    std::vector<OperatorCommand> out;
    for (int i = 0; i < 100 && out.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      out = operators.take();
    }
    return out;
  }

  OperatorQueue operators;
  MessageLog log;

 private:
  void publish_all() {
    constexpr std::chrono::milliseconds kInterval{50};
    cv::Mat ground(480, 640, CV_8UC1);
    cv::RNG(1).fill(ground, cv::RNG::UNIFORM, 0, 256);
    FlightStatus status{.has_station = true};
    while (!is_ended_) {
      PageSnapshot snapshot = snapshot_at(local_now());
      snapshot.grey = ground;
      ++status.used_images;
      ++status.images.decoded;
      if (change_) change_(snapshot, status);
      page_.publish(std::move(snapshot), status);
      std::this_thread::sleep_for(kInterval);
    }
  }

  Change change_;
  FlightPage page_;
  std::atomic<bool> is_ended_ = false;
  std::thread thread_;
};

std::string text_is(const std::string& id, const std::string& text) {
  return "document.getElementById('" + id + "').textContent === '" + text + "'";
}

class FlightPageInBrowser : public BrowserTest {
 protected:
  void SetUp() override {
    unsetenv(kPageToken);
    BrowserTest::SetUp();
    if (browser_) session.emplace(*browser_, folder_.path());
  }
  void TearDown() override {
    unsetenv(kPageToken);
    session.reset();
  }
  void expect_no_errors() {
    EXPECT_EQ(session->evaluate("document.documentElement.dataset.errors || ''"), "");
  }

  std::optional<BrowserSession> session;
};

TEST_F(FlightPageInBrowser, ShowsVideoValuesAndHistory) {
  const SyntheticFlightPage flight;
  session->open(flight.url(), 1300);
  EXPECT_TRUE(session->wait_until("document.getElementById('image').naturalWidth === 640"));
  EXPECT_TRUE(session->wait_until(text_is("speed", "0.50m/s")));
  EXPECT_TRUE(session->wait_until(text_is("height", "2.00m")));
  EXPECT_TRUE(session->wait_until(text_is("displacement", "0.50m")));
  EXPECT_TRUE(session->wait_until(text_is("displacement-note", "95 %: 2.4 × 2.4 cm\\nup 0.00 m")));
  EXPECT_TRUE(session->wait_until(text_is("scale", "initial height")));
  EXPECT_TRUE(session->wait_until(text_is("scale-note", "1 min 30 s old")));
  EXPECT_TRUE(session->wait_until(text_is("latency", "25ms")));
  EXPECT_TRUE(session->wait_until(text_is("verdict", "measured")));
  EXPECT_TRUE(session->wait_until("parseInt(document.getElementById('rate').textContent) > 10"));
  EXPECT_EQ(session->evaluate("document.querySelectorAll('.chart canvas').length"), 4);
  EXPECT_EQ(session->evaluate("document.querySelectorAll('#alarms li').length"), 0);
  expect_no_errors();
}

TEST_F(FlightPageInBrowser, ShowsAlarmsInWords) {
  const SyntheticFlightPage flight([](PageSnapshot& snapshot, FlightStatus& status) {
    snapshot.step.estimate.verdict = Verdict::lost;
    snapshot.step.decision.reason = HoldReason::not_measured;
    status.is_engaged = true;
  });
  session->open(flight.url(), 390);
  EXPECT_TRUE(session->wait_until("document.querySelectorAll('#alarms li').length === 2"));
  EXPECT_EQ(session->evaluate("document.querySelector('#alarms li').textContent"),
            "Engaged, but no image is measured");
  EXPECT_TRUE(session->wait_until(text_is("control-state", "engaged")));
  EXPECT_TRUE(session->wait_until(
      "document.getElementById('verdict-times').textContent.startsWith('Not measured: lost')"));
  expect_no_errors();
}

TEST_F(FlightPageInBrowser, ReplayHasItsTimeAndNoButtons) {
  const SyntheticFlightPage flight([](PageSnapshot& snapshot, FlightStatus& status) {
    snapshot.latency_s = std::nan("");
    status.is_engaged = true;
    status.replay = FlightStatus::Replay{.speed = 4, .time_s = 75, .has_ended = false};
  });
  session->open(flight.url(), 390);
  EXPECT_TRUE(session->wait_until(text_is("replay", "replay 1 min 15 s × 4")));
  EXPECT_TRUE(session->wait_until(text_is("control-state", "engaged")));
  EXPECT_EQ(session->evaluate("document.getElementById('control').hidden"), true);
  EXPECT_EQ(session->evaluate("document.getElementById('take').offsetWidth"), 0);
  EXPECT_EQ(session->evaluate("document.getElementById('latency').textContent"), "–");
  expect_no_errors();
}

TEST_F(FlightPageInBrowser, ButtonsCommandOnceControlIsTaken) {
  for (const int width_px : {390, 1300}) {
    SyntheticFlightPage flight;
    session->open(flight.url(), width_px);
    ASSERT_TRUE(
        session->wait_until("!document.getElementById('take').disabled && "
                            "document.getElementById('take').offsetWidth > 0"));
    EXPECT_EQ(session->evaluate("document.getElementById('engage').hidden"), true);
    session->click("#take");
    ASSERT_TRUE(session->wait_until("!document.getElementById('engage').hidden"));
    for (const auto& [button, action] : {std::pair{"#engage", OperatorAction::engage},
                                         {"#release", OperatorAction::release},
                                         {"#hold-here", OperatorAction::hold_here},
                                         {"#stop", OperatorAction::stop}}) {
      session->click(button);
      const std::vector<OperatorCommand> commands = flight.commands();
      ASSERT_EQ(commands.size(), 1U) << button << " at " << width_px << " px";
      EXPECT_EQ(commands[0].action, action);
    }
    session->click("#note");
    session->type("gust of wind");
    session->click("#mark");
    const std::vector<OperatorCommand> marks = flight.commands();
    ASSERT_EQ(marks.size(), 1U);
    EXPECT_EQ(marks[0].action, OperatorAction::mark);
    EXPECT_EQ(marks[0].note, "gust of wind");
    flight.log.add(local_now(), "operator: release");
    EXPECT_TRUE(session->wait_until(text_is("answer", "release: accepted")));
    flight.log.add(local_now(), "operator: engage refused: stopped for this flight");
    EXPECT_TRUE(session->wait_until(text_is("answer", "engage refused: stopped for this flight")));
    session->click("#return");
    EXPECT_TRUE(session->wait_until(text_is("control-note", "Nobody has control.")));
    expect_no_errors();
  }
}

TEST_F(FlightPageInBrowser, SecondOperatorWatchesOnly) {
  SyntheticFlightPage flight;
  session->open(flight.url(), 1300);
  ASSERT_TRUE(session->wait_until("document.getElementById('take').offsetWidth > 0"));
  session->click("#take");
  ASSERT_TRUE(session->wait_until("!document.getElementById('engage').hidden"));
  session->open(flight.url(), 390);
  ASSERT_TRUE(session->wait_until(
      text_is("control-note", "Another operator has control; this page only watches.")));
  EXPECT_EQ(session->evaluate("document.getElementById('take').disabled"), true);
  session->click("#take");
  session->evaluate("act('/command', JSON.stringify({command: 'engage'}), '')");
  EXPECT_TRUE(session->wait_until(text_is("answer", "Not sent: take control first")));
  EXPECT_TRUE(flight.operators.take().empty());
  session->select(0);
  EXPECT_EQ(session->evaluate("document.getElementById('engage').hidden"), false);
}

TEST_F(FlightPageInBrowser, ConnectsAgainByItself) {
  auto flight = std::make_unique<SyntheticFlightPage>();
  const int port = flight->port();
  session->open(flight->url(), 390);
  ASSERT_TRUE(session->wait_until(text_is("speed", "0.50m/s")));
  flight.reset();
  ASSERT_TRUE(session->wait_until(
      "document.getElementById('alarms').textContent.startsWith('No connection to the program')"));
  EXPECT_EQ(session->evaluate("document.getElementById('main').className"), "stale");
  flight = std::make_unique<SyntheticFlightPage>(
      [](PageSnapshot& snapshot, FlightStatus&) {
        snapshot.step.estimate.velocity_in_world_m_s.setZero();
      },
      port);
  EXPECT_TRUE(session->wait_until(text_is("speed", "0.00m/s")));
  EXPECT_EQ(session->evaluate("document.querySelectorAll('#alarms li').length"), 0);
  const std::string before = session->evaluate("document.getElementById('image').src");
  EXPECT_TRUE(session->wait_until("document.getElementById('image').src !== '" + before + "'"));
  expect_no_errors();
}

TEST_F(FlightPageInBrowser, AsksForTheToken) {
  setenv(kPageToken, "0123456789abcdef", 1);
  const SyntheticFlightPage flight;
  session->open(flight.url(), 390);
  ASSERT_TRUE(session->wait_until("!document.getElementById('token-form').hidden"));
  EXPECT_EQ(session->evaluate("document.getElementById('speed').textContent"), "–");
  session->click("#token");
  session->type("0123456789abcdef");
  session->click("#token-form button");
  EXPECT_TRUE(session->wait_until(text_is("speed", "0.50m/s")));
  EXPECT_TRUE(session->wait_until("document.getElementById('token-form').hidden"));
}

TEST_F(FlightPageInBrowser, FitsAPhone) {
  const SyntheticFlightPage flight;
  session->open(flight.url(), 390);
  ASSERT_TRUE(session->wait_until(text_is("speed", "0.50m/s")));
  EXPECT_EQ(session->evaluate("document.documentElement.scrollWidth - "
                              "document.documentElement.clientWidth"),
            0);
  // fingers need 9 mm, 48 px
  EXPECT_EQ(
      session->evaluate("[...document.querySelectorAll('button')].filter(b => b.offsetWidth && "
                        "(b.offsetHeight < 48 || b.offsetWidth < 48)).length"),
      0);
}

}  // namespace
}  // namespace stillkite
