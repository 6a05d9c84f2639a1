// A report as one HTML file: the template with styles, scripts, the chart library and its licence,
// and the data as JSON, which the scripts draw. Nothing is loaded from elsewhere, and the page's
// policy forbids it. Same data, same bytes.
#pragma once

#include <string>

#include "tools/app/table/json.h"

namespace leviosim::tools {

/// The data of a report: {"format", "version", "title", "mechanisms": [{"key", "group"}…], "runs":
/// [run_json()…]} and, where there are some, "comparisons", "check", "study".
Json report_json(const std::string& title, Json runs);

/// A page of other scripts than those that show runs.
struct PageScripts {
  std::string scripts;  ///< after those for elements, tables, charts and figures
  std::string blocks;   ///< inert elements before them, with what they read
  std::string policy;   ///< what they may do besides, in the words of Content-Security-Policy
};

/// The file. @param data  of report_json()
std::string html_page(const Json& data);
std::string html_page(const Json& data, const PageScripts& others);

/// JSON that may stand in a <script>: no text of it can end the element.
std::string script_json(const Json& json);

}  // namespace leviosim::tools
