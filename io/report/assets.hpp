#pragma once

#include <string_view>

/// The files of this folder and the dygraphs library, compiled in (report.cmake).
namespace stillkite::report_assets {

extern const std::string_view kPage;  ///< what all reports have in common
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

}  // namespace stillkite::report_assets
