#include <gtest/gtest.h>

#include <limits>

#include "tests/browser/browser_test.hpp"
#include "tests/browser/synthetic_comparison.hpp"

namespace stillkite {
namespace {

TEST(ComparisonReport, IsSmallAndSelfContained) {
  SyntheticComparison made;
  compare_synthetic_flights(made, 20000, true);
  const std::string html = comparison_report_html(made.content("flight", true), made.comparison);
  EXPECT_LT(html.size(), 1'500'000U);
  EXPECT_EQ(html.find("<script src"), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
}

using ComparisonInBrowser = BrowserTest;

// 3 positions, speed, 3 errors, time; dygraphs uses two canvases per chart.
TEST_F(ComparisonInBrowser, DrawsEveryChartOfTwoEstimators) {
  SyntheticComparison made;
  compare_synthetic_flights(made, 600, true);
  const std::string dom =
      show(comparison_report_html(made.content("flight.yaml", true), made.comparison));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "8");
  EXPECT_EQ(count(dom, "<canvas"), 8 * 2 + 1 + 2) << "path, and verdicts of both";
  EXPECT_EQ(count(dom, "class=\"badge worse\""), 1) << "one significant difference";
  EXPECT_NE(dom.find("0.101 … 0.225"), std::string::npos);
}

TEST_F(ComparisonInBrowser, OmitsLengthsOfEstimatorWithoutScale) {
  SyntheticComparison made;
  compare_synthetic_flights(made, 300, false);
  std::string html = comparison_report_html(made.content("flight.yaml", true), made.comparison);
  html.insert(html.rfind("</body>"), R"(<script>
    const lines = id => document.querySelector(`#${id} .plot`).chart.lines.map(line => line.label);
    document.documentElement.dataset.position = lines('position').join();
    document.documentElement.dataset.timing = lines('timing').join();
  </script>)");
  const std::string dom = show(html);
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "position"), "truth,estimator 0");
  EXPECT_EQ(root_data(dom, "timing"), "estimator 0,estimator 1");
  EXPECT_NE(dom.find("reference has no scale"), std::string::npos);
}

TEST_F(ComparisonInBrowser, RendersWithoutTruthAndWithoutData) {
  SyntheticComparison made;
  compare_synthetic_flights(made, 300, true);
  made.comparison["differences"] = nlohmann::json::array();
  std::string dom =
      show(comparison_report_html(made.content("flight.yaml", false), made.comparison));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "5");
  dom = show(comparison_report_html({}, nlohmann::json::object()));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "0");
}

TEST_F(ComparisonInBrowser, HandlesHostileTextNonFiniteNumbersAndUnequalLengths) {
  const std::string hostile = "</script><script>document.title='owned'</script>{{data}}'\"&";
  SyntheticComparison made;
  compare_synthetic_flights(made, 300, true);
  made.first.config_yaml = hostile;
  made.first.estimates[7].world_from_body.translation.setConstant(
      std::numeric_limits<double>::quiet_NaN());
  made.first.truth[9] = std::nullopt;
  made.names[1] = hostile;
  made.second.estimates.resize(299);
  made.comparison["estimators"][1]["name"] = hostile;
  const std::string dom =
      show(comparison_report_html(made.content(hostile, true), made.comparison));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "8");
  EXPECT_EQ(dom.find("<title>owned"), std::string::npos);
}

}  // namespace
}  // namespace stillkite
