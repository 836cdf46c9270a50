#include "io/report/study_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/browser/browser_test.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

json job(const std::string& id, const std::string& configuration, const json& value) {
  return {{"id", id},
          {"flight", "f"},
          {"flight_group", "f"},
          {"configuration", configuration},
          {"estimator", ""},
          {"seed", 1},
          {"status", value.is_null() ? "failed" : "finished"},
          {"failure", value.is_null() ? json("f.mp4: no such file") : json(nullptr)},
          {"wall_s", 2},
          {"results", fmt::format("jobs/{}/report.html", id)},
          {"messages", value.is_null() ? fmt::format("jobs/{}.txt", id) : ""},
          {"figures", {{"error_m", value}, {"not a metric", 4711}}}};
}

// Two configurations of two jobs, one of which failed.
json small_study() {
  const json none{{"samples", 1},        {"median", 0.25},
                  {"low", nullptr},      {"high", nullptr},
                  {"nine_in_ten", 0.25}, {"worst", 0.25},
                  {"worst_job", "d"},    {"worst_results", "jobs/d/report.html"}};
  const json two{{"samples", 2},         {"median", 0.5},
                 {"low", 0.125},         {"high", 0.875},
                 {"nine_in_ten", 0.875}, {"worst", 0.875},
                 {"worst_job", "b"},     {"worst_results", "jobs/b/report.html"}};
  const auto group = [](const char* name, const json& figures) {
    return json{{"configuration", name},
                {"estimator", ""},
                {"flight_group", ""},
                {"jobs", 2},
                {"finished", 2},
                {"failed", 0},
                {"figures", {{"error_m", figures}}}};
  };
  return {{"command", "run"},
          {"metrics", {{{"figure", "error_m"}, {"worst", "highest"}}}},
          {"groups", {group("calm", two), group("windy", none)}},
          {"jobs",
           {job("c", "windy", nullptr), job("b", "calm", 0.875), job("d", "windy", 0.25),
            job("a", "calm", 0.125)}}};
}

TEST(StudyReport, IsSelfContainedAndHasTheMetricsOnly) {
  const std::string html = study_report_html(
      {.title = "s.yaml", .study_yaml = "flights: []\n", .overrides = {"seeds=[1]"}},
      small_study());
  EXPECT_EQ(html.find("<script src"), std::string::npos);
  EXPECT_EQ(html.find("not a metric"), std::string::npos);
  EXPECT_NE(html.find("# --set seeds=[1]"), std::string::npos);
}

using StudyInBrowser = BrowserTest;

TEST_F(StudyInBrowser, ShowsMediansValuesAndLinks) {
  const std::string dom = show(study_report_html({.title = "s.yaml"}, small_study()));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "1");
  EXPECT_EQ(count(dom, "<circle"), 3) << "one per job with a value";
  EXPECT_EQ(count(dom, "class=\"interval\""), 1);
  EXPECT_EQ(count(dom, "class=\"incomplete\""), 1) << "1 of 2 jobs";
  EXPECT_NE(dom.find("0.125 … 0.875"), std::string::npos);
  EXPECT_EQ(count(dom, "href=\"jobs/b/report.html\""), 2) << "worst value and job";
  EXPECT_NE(dom.find(": f.mp4: no such file</li>"), std::string::npos);
  EXPECT_LT(dom.find(">c</a></td>"), dom.find(">b</a></td>")) << "order of study.json";
}

TEST_F(StudyInBrowser, EscapesTextsAndRendersWithoutJobs) {
  const std::string hostile = "</script><script>document.title='owned'</script>{{data}}'\"&";
  json study = small_study();
  study["jobs"][0]["failure"] = hostile;
  study["groups"][0]["configuration"] = hostile;
  std::string dom = show(study_report_html({.title = hostile, .study_yaml = hostile}, study));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(dom.find("<title>owned"), std::string::npos);
  for (const char* list : {"jobs", "groups", "metrics"}) study[list] = json::array();
  dom = show(study_report_html({}, study));
  EXPECT_EQ(root_data(dom, "errors"), std::nullopt);
  EXPECT_EQ(root_data(dom, "ready"), "0");
}

}  // namespace
}  // namespace stillkite
