#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace stillkite {

/// What one kind of report fills the common page with. The texts of the user are escaped, those
/// compiled in (report/assets.hpp) are not.
struct ReportPage {
  std::string_view brand;
  std::string_view main;  ///< `{{config}}` in it becomes the configuration
  std::string_view style;
  std::string_view script;
  std::string_view reset;   ///< says what the button does that ends a zoom
  std::string_view footer;  ///< how the charts are used
  std::string title;        ///< the user's, like config_yaml
  std::string config_yaml;
};

/// One self-contained HTML page; `data` is what its script draws.
[[nodiscard]] std::string report_page(const ReportPage& page, const nlohmann::json& data);

}  // namespace stillkite
