#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/browser/browser_test.hpp"
#include "tests/browser/synthetic_trials.hpp"

namespace stillkite {
namespace {

using HoverReportInBrowser = BrowserTest;

std::string page_of(const SyntheticTrials& trials) {
  return hover_report_html(trials.content("trials_paper.yaml"), synthetic_hover_summary(trials));
}

/// Page with an additional script, which writes results to `root` for root_data().
std::string visited(std::string html, const std::string& script) {
  html.insert(html.rfind("</body>"),
              "<script>{ const root = document.documentElement.dataset;"
              "const $ = id => document.getElementById(id);" +
                  script + "}</script>");
  return html;
}

TEST_F(HoverReportInBrowser, DrawsTableAndFiguresOfTheHoldPaper) {
  const SyntheticTrials trials = synthetic_trials();
  const std::string dom = show(page_of(trials));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  // canvases: Fig. 5, two each; Fig. 4, one each; Fig. 3, on and off each; replay views and strip
  EXPECT_EQ(root_data(dom, "ready"), std::to_string(3 * 2 + 3 + 3 * 2 + 3));
  EXPECT_EQ(count(dom, "class=\"papers\"> / "), 16);
  EXPECT_NE(dom.find("hold paper: 34 cm"), std::string::npos);
  EXPECT_NE(dom.find("12 simulated trials: 9 with stabilization, 3 without"), std::string::npos);
  EXPECT_NE(dom.find("policy: reference"), std::string::npos);
}

TEST_F(HoverReportInBrowser, RendersASubsetOfTheAxes) {
  SyntheticTrials trials = synthetic_trials();
  trials.trials = {trials.trials[5], trials.trials[7]};
  nlohmann::json summary = synthetic_hover_summary(trials);
  summary["table"]["on"]["x"] = nullptr;
  summary["table"]["on"]["z"] = {{"mean_m", nullptr}, {"std_m", nullptr}, {"max_m", nullptr}};
  const std::string dom = show(hover_report_html(trials.content("y only"), summary));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), std::to_string(2 + 1 + 2 + 3));
}

TEST_F(HoverReportInBrowser, RendersWithoutData) {
  for (const auto& summary : {nlohmann::json(), nlohmann::json::object()}) {
    const std::string dom = show(hover_report_html({}, summary));
    EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
    EXPECT_EQ(root_data(dom, "ready"), "0");
  }
}

TEST_F(HoverReportInBrowser, HandlesHostileTextAndNonFiniteNumbers) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::string hostile = "</pre></script><script>document.title='owned'</script>{{data}}'\"&";
  SyntheticTrials trials = synthetic_trials();
  trials.config_yaml = hostile;
  HoverReportTrial& trial = trials.trials[0];
  trial.policy = hostile;
  trial.samples[3].reason = hostile;
  trial.samples[4].reason = "constructor";
  trial.samples[5].displacement_m.setConstant(kNaN);
  trial.samples[6].drone_in_world_m.setConstant(std::numeric_limits<double>::infinity());
  trial.samples[7].station_in_world_m.setConstant(kNaN);
  trial.samples[8].yaw_deg = kNaN;
  trial.samples[9].t_s = kNaN;
  trial.images[0].jpeg = {1, 2, 3};
  for (HoverReportSample& sample : trials.trials[1].samples) sample = {.t_s = kNaN};
  trials.trials[2].samples.clear();
  const std::string dom =
      show(visited(hover_report_html(trials.content(hostile), synthetic_hover_summary(trials)),
                   R"(for (const place of ['0', '1', '3']) {
           $('replay_trial').value = place;
           $('replay_trial').dispatchEvent(new Event('change'));
           for (const t of [0.13, 0.2, 0.25]) { $('scrub').value = t; $('scrub').dispatchEvent(new Event('input')); }
         })"));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "18");
  EXPECT_EQ(dom.find("<title>owned"), std::string::npos);
  EXPECT_NE(dom.find("{{data}}"), std::string::npos);
}

// Seeks to 5.5 s, then plays 0.5 s of simulated clock at double speed.
TEST_F(HoverReportInBrowser, ReplaysATrial) {
  const SyntheticTrials trials = synthetic_trials();
  const std::string dom = show(visited(page_of(trials), R"(
    let next = null;
    window.requestAnimationFrame = callback => { next = callback; return 1; };
    $('scrub').value = 5.5;
    $('scrub').dispatchEvent(new Event('input'));
    root.scrubbed = $('readings').textContent;
    root.decided = $('decision').textContent;
    const before = $('image').src;
    $('replay_speed').value = '2';
    $('replay_speed').dispatchEvent(new Event('change'));
    $('play').click();
    next(1000); next(1500);
    root.played = $('scrub').value;
    root.another = before !== $('image').src && before.startsWith('data:image/jpeg;base64,/9j');
    $('play').click();
    next(9000);
    root.paused = $('scrub').value;
    $('play').click();
    next(1e4); next(1e6);
    root.ended = `${$('scrub').value === $('scrub').max} ${$('play').ariaLabel}`;
    $('replay_trial').value = '3';
    $('replay_trial').dispatchEvent(new Event('change'));
    root.off = `${$('scrub').value} ${$('camera').hidden} ${$('decision').textContent}`;
  )"));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  const HoverReportSample& sample = trials.trials[0].samples[165];
  const double d_cm = std::round(1000 * sample.displacement_m.x()) / 10;
  const std::string scrubbed = root_data(dom, "scrubbed").value_or("");
  EXPECT_NE(scrubbed.find("time 5.5 s"), std::string::npos) << scrubbed;
  const std::size_t at = scrubbed.find("d = dx ");
  ASSERT_NE(at, std::string::npos) << scrubbed;
  EXPECT_NEAR(std::stod(scrubbed.substr(at + 7)), d_cm, 1) << "the page decimates the samples";
  EXPECT_EQ(root_data(dom, "decided"), "command: position and yaw are controlled");
  EXPECT_EQ(root_data(dom, "played"), "6.5");
  EXPECT_EQ(root_data(dom, "another"), "true");
  EXPECT_EQ(root_data(dom, "paused"), "6.5");
  EXPECT_EQ(root_data(dom, "ended"), "true Play");
  EXPECT_EQ(root_data(dom, "off"), "0 true no stabilization: the drone follows its station");
}

TEST_F(HoverReportInBrowser, SortsTrialsAndResetsZoom) {
  const SyntheticTrials trials = synthetic_trials();
  const std::string dom = show(visited(page_of(trials), R"(
    const head = [...document.querySelectorAll('#trials th')].find(th => th.textContent === 'mean');
    const means = () => [...document.querySelectorAll('#trials tbody tr')].map(row => Number(row.cells[4].textContent));
    const sorted = values => values.every((value, i) => !i || values[i - 1] <= value);
    root.before = sorted(means());
    head.querySelector('button').click();
    root.upward = sorted(means());
    head.querySelector('button').click();
    root.downward = sorted(means().reverse());
    const graph = document.querySelector('#displacement .plot').chart.graph;
    graph.updateOptions({dateWindow: [10, 20]});
    root.button = !$('reset').hidden;
    $('reset').click();
    root.whole = graph.xAxisRange().map(Math.round).join();
  )"));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "before"), "false");
  EXPECT_EQ(root_data(dom, "upward"), "true");
  EXPECT_EQ(root_data(dom, "downward"), "true");
  EXPECT_EQ(root_data(dom, "button"), "true");
  EXPECT_EQ(root_data(dom, "whole"), "0,40");
}

}  // namespace
}  // namespace stillkite
