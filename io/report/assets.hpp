#pragma once

#include <string_view>

/// Files of this folder and the dygraphs library, embedded at build time (report.cmake).
namespace stillkite::report_assets {

extern const std::string_view kPage;  ///< common page of all reports
extern const std::string_view kDygraphs;
extern const std::string_view kDygraphsStyle;

extern const std::string_view kReportMain;
extern const std::string_view kReportStyle;
extern const std::string_view kReportScript;

extern const std::string_view kHoverMain;
extern const std::string_view kHoverStyle;
extern const std::string_view kHoverScript;

extern const std::string_view kComparisonMain;
extern const std::string_view kComparisonStyle;
extern const std::string_view kComparisonScript;

extern const std::string_view kCalibrationMain;
extern const std::string_view kCalibrationStyle;
extern const std::string_view kCalibrationScript;

extern const std::string_view kStudyMain;
extern const std::string_view kStudyStyle;
extern const std::string_view kStudyScript;

}  // namespace stillkite::report_assets
