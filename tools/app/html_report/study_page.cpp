#include "tools/app/html_report/study_page.h"

#include <algorithm>

#include "tools/app/html_report/page.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

/// As people see them: in the unit of the column, and in words where a path diverged.
Json cells_for_people(Json cells, const Head& column) {
  for (Json& cell : cells) {
    if (!cell.is_number()) continue;
    const auto value = cell.get<double>();
    if (is_diverged(column, value))
      cell = kDiverged;
    else if (column.scale != 1)
      cell = value * column.scale;
  }
  return cells;
}

bool is_empty(const Json& cells) {
  return std::all_of(cells.begin(), cells.end(), [](const Json& cell) { return cell.is_null(); });
}

}  // namespace

Json study_report(const StudyPage& page) {
  Json data = report_json(page.title, Json::array());
  Json& study = data["study"];
  constexpr std::string_view kConclusion = "in short: ";
  std::string_view summary = page.summary;
  study["boxes"] = Json::array();
  if (summary.starts_with(kConclusion)) {
    const std::string_view line = summary.substr(0, summary.find('\n'));
    summary.remove_prefix(line.size());
    study["boxes"].push_back({{"good", nullptr},
                              {"mark", "Answer"},
                              {"sentence", line.substr(kConclusion.size())},
                              {"lines", Json::array()}});
  }
  study["summary"] = summary;
  for (const StudyBox& box : page.boxes)
    study["boxes"].push_back({{"good", box.good ? Json(*box.good) : Json(nullptr)},
                              {"mark", box.mark},
                              {"sentence", box.sentence},
                              {"lines", box.lines}});
  study["found"] = Json::array();
  for (const auto& [title, table] : page.found) {
    std::vector<std::vector<std::string>> rows = shown_cells(table);
    const std::vector<std::string> titles = std::move(rows.front());
    rows.erase(rows.begin());
    study["found"].push_back({{"title", title}, {"titles", titles}, {"rows", rows}});
  }
  const Json table = columns_json(page.points);
  study["columns"] = Json::array();
  study["table"] = Json::object();
  for (const Head& column : page.columns.empty() ? page.points.heads() : page.columns) {
    if (column.title.empty() || !table.contains(column.key) || is_empty(table.at(column.key)))
      continue;
    study["columns"].push_back({{"name", column.key},
                                {"title", column.title},
                                {"unit", column.unit},
                                {"kind", column.is_setup ? "setup" : "figure"},
                                {"more", column.more_is_better}});
    study["table"][column.key] = cells_for_people(table.at(column.key), column);
  }
  const auto known = [&](const std::string& name) { return study["table"].contains(name); };
  const auto axis = [&](const std::string& wanted, std::size_t other) {
    if (known(wanted) || study["columns"].empty()) return Json(wanted);
    return study["columns"][std::min(other, study["columns"].size() - 1)]["name"];
  };
  study["axes"] = Json::array({axis(page.x, 0), axis(page.y, 1)});
  study["colour"] = known(page.colour) ? page.colour : "";
  study["limits"] = page.limits;
  if (page.curves && known(page.curves->x) &&
      (page.curves->series.empty() || known(page.curves->series)))
    study["curves"] = {{"x", page.curves->x},
                       {"series", page.curves->series},
                       {"y", page.curves->y},
                       {"hint", page.curves->hint},
                       {"fromZero", page.curves->from_zero},
                       {"names", page.curves->names},
                       {"marks", page.curves->marks}};
  if (page.bars)
    study["bars"] = {
        {"of", page.bars->of}, {"figures", page.bars->figures}, {"title", page.bars->title}};
  return data;
}

}  // namespace leviosim::tools
