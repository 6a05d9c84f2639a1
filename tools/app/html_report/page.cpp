#include "tools/app/html_report/page.h"

#include <algorithm>

#include "sim/base/check.h"
#include "sim/chip/account.h"
#include "tools/app/cli/screen.h"
#include "tools/app/html_report/page_parts.h"
#include "tools/app/table/json.h"

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
std::string scripts(std::initializer_list<const char*> names) {
  std::string text;
  for (const char* name : names) text += part(name);
  return text;
}

/// What the template has in place of a field such as "{{title}}".
std::string content(std::string_view field, const Json& data, const PageScripts& page) {
  if (field == "title") return escape_markup(data.at("title").get<std::string>());
  if (field == "data") return script_json(data);
  if (field == "scripts") return page.scripts;
  if (field == "blocks") return page.blocks;
  if (field == "policy") return page.policy;
  if (field == "licence") return escape_markup(part("copyright"));
  return std::string(part(field));
}

}  // namespace

Json report_json(const std::string& title, Json runs) {
  Json data;
  data["format"] = "leviosim report";
  data["version"] = 1;
  data["title"] = title;
  data["mechanisms"] = Json::array();
  for (const sim::MechanismInfo& info : sim::kMechanisms)
    if (!info.column.empty())
      data["mechanisms"].push_back({{"key", info.key}, {"group", info.column}});
  data["runs"] = std::move(runs);
  return data;
}

std::string html_page(const Json& data) {
  return html_page(data, {scripts({"frames", "stages", "memory", "energy", "runs", "compare",
                                   "check", "study", "history", "main"}),
                          "", ""});
}

std::string html_page(const Json& data, const PageScripts& others) {
  PageScripts with_shared = others;
  with_shared.scripts =
      scripts({"dom", "table", "charting", "figures", "trajectory"}) + others.scripts;
  std::string page;
  std::string_view rest = part("template");
  for (std::size_t begin = rest.find("{{"); begin != std::string_view::npos;
       begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    page += rest.substr(0, begin);
    page += content(rest.substr(begin + 2, end - begin - 2), data, with_shared);
    rest.remove_prefix(end + 2);
  }
  page += rest;
  return page;
}

std::string script_json(const Json& json) {
  const std::string plain = json_text(json);
  std::string text;
  text.reserve(plain.size());
  for (std::size_t from = 0; from < plain.size();) {
    const std::size_t at = std::min(plain.find('<', from), plain.size());
    text.append(plain, from, at - from);
    if (at < plain.size()) text += "\\u003c";
    from = at + 1;
  }
  return text;
}

}  // namespace leviosim::tools
