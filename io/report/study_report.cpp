#include "io/report/study_report.hpp"

#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"
#include "io/report/report_page.hpp"

namespace stillkite {
namespace {

// The page shows the figures of the metrics only.
nlohmann::json study_data(const nlohmann::json& study) {
  nlohmann::json shown = study;
  for (nlohmann::json& job : shown["jobs"]) {
    nlohmann::json figures = nlohmann::json::object();
    for (const nlohmann::json& metric : study.at("metrics")) {
      const std::string figure = metric.at("figure").get<std::string>();
      figures[figure] = job.at("figures").value(figure, nlohmann::json(nullptr));
    }
    job["figures"] = std::move(figures);
  }
  return {{"summary", shown}};
}

}  // namespace

std::string study_report_html(const StudyReportContent& content, const nlohmann::json& study) {
  std::string text = content.study_yaml;
  for (const std::string& override_text : content.overrides)
    text += "# --set " + override_text + '\n';
  return report_page({.brand = "Stillkite study",
                      .main = report_assets::kStudyMain,
                      .style = report_assets::kStudyStyle,
                      .script = report_assets::kStudyScript,
                      .reset = "",
                      .footer = "Click a column header to sort the jobs.",
                      .title = content.title,
                      .config_yaml = text},
                     study_data(study));
}

}  // namespace stillkite
