#include <gtest/gtest.h>

#include <limits>

#include "tests/browser/browser_test.hpp"
#include "tests/browser/synthetic_flight.hpp"

namespace stillkite {
namespace {

using ReportInBrowser = BrowserTest;

TEST_F(ReportInBrowser, DrawsEveryChartOfFlightWithTruth) {
  const SyntheticFlight flight = synthetic_flight(3750);
  const std::string dom =
      show(report_html(flight.content("flight.mp4", true), synthetic_summary(flight)));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "24");
  // two canvases per dygraphs chart, one each for path and verdicts
  EXPECT_EQ(count(dom, "<canvas"), 24 * 2 + 2);
  EXPECT_NE(dom.find("0.0324"), std::string::npos) << "drift is a key figure";
  EXPECT_NE(dom.find("mode: recommended"), std::string::npos);
}

TEST_F(ReportInBrowser, RendersWithoutTruth) {
  const SyntheticFlight flight = synthetic_flight(200);
  nlohmann::json summary = synthetic_summary(flight);
  summary.erase("evaluation");
  const std::string dom = show(report_html(flight.content("flight.mp4", false), summary));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "15");
}

TEST_F(ReportInBrowser, RendersWithoutData) {
  const std::string dom = show(report_html({}, nlohmann::json::object()));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "0");
}

TEST_F(ReportInBrowser, HandlesHostileTextAndNonFiniteNumbers) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::string hostile = "</pre></script><script>document.title='owned'</script>{{data}}'\"&";
  SyntheticFlight flight = synthetic_flight(300);
  flight.config_yaml = hostile;
  nlohmann::json summary = synthetic_summary(flight);
  summary["verdicts"][hostile] = 3;
  summary["scale"]["source"] = hostile;
  flight.estimates[7].world_from_body.translation.setConstant(kNaN);
  flight.estimates[8].world_from_body.rotation.coeffs().setConstant(kNaN);
  flight.estimates[9].velocity_in_world_m_s.setConstant(std::numeric_limits<double>::infinity());
  flight.estimates[10].twist_covariance.setConstant(kNaN);
  flight.truth[20] = std::nullopt;
  const std::string dom = show(report_html(flight.content(hostile, true), summary));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "24");
  EXPECT_EQ(dom.find("<title>owned"), std::string::npos);
  EXPECT_NE(dom.find("{{data}}"), std::string::npos);
}

// Drags the pointer across one chart and compares the time range of the others.
TEST_F(ReportInBrowser, ZoomsAllChartsTogether) {
  const SyntheticFlight flight = synthetic_flight(500);
  std::string html = report_html(flight.content("flight.mp4", true), synthetic_summary(flight));
  const std::string visitor = R"(<script>
    const plots = [...document.querySelectorAll('.plot')];
    const canvas = plots[0].querySelectorAll('canvas')[1];
    const box = canvas.getBoundingClientRect();
    const at = (kind, share, target) => target.dispatchEvent(new MouseEvent(kind, {bubbles: true,
      cancelable: true, view: window, button: 0, clientX: box.left + 46 + share * (box.width - 46),
      clientY: box.top + 40}));
    at('mousedown', 0.2, canvas); at('mousemove', 0.4, document); at('mousemove', 0.6, document);
    at('mouseup', 0.6, document);
    const ranges = plots.map(plot => plot.chart.graph.xAxisRange().map(t => t.toFixed(6)).join());
    const root = document.documentElement.dataset;
    root.ranges = new Set(ranges.slice(0, 6)).size;
    root.range = ranges[1];
    root.button = !document.getElementById('reset').hidden;
    document.getElementById('reset').click();
    root.whole = plots[0].chart.graph.xAxisRange().map(t => Math.round(t)).join();
  </script>)";
  html.insert(html.rfind("</body>"), visitor);
  const std::string dom = show(html);
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ranges"), "1") << "one range for all visible charts";
  EXPECT_EQ(root_data(dom, "button"), "true");
  EXPECT_EQ(root_data(dom, "whole"), "0,150");
  const std::string range = root_data(dom, "range").value_or("0,0");
  EXPECT_NEAR(std::stod(range), 0.2 * 150, 6);
  EXPECT_NEAR(std::stod(range.substr(range.find(',') + 1)), 0.6 * 150, 6);
}

}  // namespace
}  // namespace stillkite
