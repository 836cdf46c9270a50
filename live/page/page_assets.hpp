#pragma once

#include <string_view>

/// Files of this folder, embedded at build time (page.cmake).
namespace stillkite::page_assets {

extern const std::string_view kHtml;
extern const std::string_view kStyle;
extern const std::string_view kScript;

}  // namespace stillkite::page_assets
