// A report as one HTML file: the template with styles, scripts, the chart library and its licence,
// and the data as JSON, which the scripts draw. Nothing is loaded from elsewhere, and the page's
// policy forbids it. Same data, same bytes.
#pragma once

#include <span>
#include <string>

#include "sim/base/builtin_file.h"
#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// The data of a report: {"format", "version", "title", "runs": [run_json()…]} and, where there are
/// some, "comparisons", "check", "study".
Json report_json(const std::string& title, Json runs);

/// The file. @param data  of report_json()
std::string html_page(const Json& data);

/// Text that may stand in an element or an attribute.
std::string html_escaped(const std::string& text);

/// JSON that may stand in a <script>: no text of it can end the element.
std::string script_json(const Json& json);

// The files of page/, and the chart library with its licence, as part of the program; generated
// when it is built (tools/embed.cmake).

/// Sorted by path.
std::span<const base::BuiltinFile> page_parts();

}  // namespace leviosim::tools
