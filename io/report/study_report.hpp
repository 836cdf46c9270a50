#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stillkite {

/// Content of a study's report.
struct StudyReportContent {
  std::string title;       ///< study file as given by the user
  std::string study_yaml;  ///< its text
  std::vector<std::string> overrides;
};

/// Self-contained HTML page of study.json (`study`): statistics and values of each metric per
/// configuration, jobs worst first with links to their reports. Texts are escaped.
[[nodiscard]] std::string study_report_html(const StudyReportContent& content,
                                            const nlohmann::json& study);

}  // namespace stillkite
