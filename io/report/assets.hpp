#pragma once

#include <string_view>

/// The files of this folder and the dygraphs library, compiled in (report.cmake).
namespace stillkite::report_assets {

extern const std::string_view kPage;
extern const std::string_view kStyle;
extern const std::string_view kScript;
extern const std::string_view kDygraphs;
extern const std::string_view kDygraphsStyle;

}  // namespace stillkite::report_assets
