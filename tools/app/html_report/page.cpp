#include "tools/app/html_report/page.h"

#include <algorithm>

#include "sim/base/check.h"

namespace leviosim::tools {
namespace {

std::string_view part(std::string_view name) {
  const auto parts = page_parts();
  const auto it = std::find_if(parts.begin(), parts.end(),
                               [&](const base::BuiltinFile& p) { return p.name == name; });
  check(it != parts.end(), "the page has all its parts");
  return it->text;
}

/// In the order in which they use each other.
std::string scripts() {
  std::string text;
  for (const char* name :
       {"dom", "table", "charting", "figures", "frames", "stages", "memory", "energy", "trajectory",
        "runs", "compare", "check", "study", "history", "main"})
    text += part(name);
  return text;
}

/// What the template has in place of a field such as "{{title}}".
std::string content(std::string_view field, const Json& data) {
  if (field == "title") return html_escaped(data.at("title").get<std::string>());
  if (field == "data") return script_json(data);
  if (field == "scripts") return scripts();
  if (field == "licence") return html_escaped(std::string(part("copyright")));
  return std::string(part(field));
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

Json report_json(const std::string& title, Json runs) {
  Json data;
  data["format"] = "leviosim report";
  data["version"] = 1;
  data["title"] = title;
  data["runs"] = std::move(runs);
  return data;
}

std::string html_page(const Json& data) {
  std::string page;
  std::string_view rest = part("template");
  for (std::size_t begin = rest.find("{{"); begin != std::string_view::npos;
       begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    page += rest.substr(0, begin);
    page += content(rest.substr(begin + 2, end - begin - 2), data);
    rest.remove_prefix(end + 2);
  }
  page += rest;
  return page;
}

std::string html_escaped(const std::string& text) {
  std::string escaped = text;
  replace_all(escaped, "&", "&amp;");
  replace_all(escaped, "<", "&lt;");
  replace_all(escaped, ">", "&gt;");
  replace_all(escaped, "\"", "&quot;");
  replace_all(escaped, "'", "&#39;");
  return escaped;
}

std::string script_json(const Json& json) {
  std::string text = json_text(json);
  replace_all(text, "<", "\\u003c");
  return text;
}

}  // namespace leviosim::tools
