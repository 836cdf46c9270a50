#include "io/report/report_page.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "io/report/assets.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

std::string escape_html(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// JSON for a script element; "<" is escaped so that the text cannot end the element.
std::string script_json(const json& value) {
  std::string text;
  for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

/// Replaces each `{{name}}` of the template in one pass; inserted texts are not expanded.
std::string expand(std::string_view page, const std::map<std::string_view, std::string>& texts) {
  std::string result;
  for (std::size_t from = 0;;) {
    const std::size_t open = page.find("{{", from);
    result += page.substr(from, open - from);
    if (open == std::string_view::npos) return result;
    const std::size_t close = page.find("}}", open);
    result += texts.at(page.substr(open + 2, close - open - 2));
    from = close + 2;
  }
}

}  // namespace

std::string report_page(const ReportPage& page, const json& data) {
  return expand(report_assets::kPage,
                {{"brand", std::string(page.brand)},
                 {"title", escape_html(page.title)},
                 {"main", expand(page.main, {{"config", escape_html(page.config_yaml)}})},
                 {"reset", std::string(page.reset)},
                 {"footer", std::string(page.footer)},
                 {"data", script_json(data)},
                 {"style", std::string(page.style)},
                 {"script", std::string(page.script)},
                 {"dygraphs_style", std::string(report_assets::kDygraphsStyle)},
                 {"dygraphs", std::string(report_assets::kDygraphs)}});
}

}  // namespace stillkite
