#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace stillkite {

/// Parts of the common page. User texts (title, config_yaml) are escaped, embedded assets
/// (report/assets.hpp) are not.
struct ReportPage {
  std::string_view brand;
  std::string_view main;  ///< contains `{{config}}`, replaced by the configuration
  std::string_view style;
  std::string_view script;
  std::string_view reset;   ///< label of the button that resets the zoom
  std::string_view footer;  ///< usage of the charts
  std::string title;        ///< user text, as config_yaml
  std::string config_yaml;
};

/// Self-contained HTML page; its script draws `data`.
[[nodiscard]] std::string report_page(const ReportPage& page, const nlohmann::json& data);

}  // namespace stillkite
