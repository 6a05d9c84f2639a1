#include "tools/app/study/sweep/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/printable_text.h"
#include "tools/app/report/text_table.h"
#include "tools/app/study/sweep/pareto.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostRows = 40;
constexpr std::size_t kMostFailures = 5;

/// Objectives that some point has.
std::vector<std::size_t> known_objectives(const std::vector<SweepOutcome>& outcomes) {
  std::vector<std::size_t> known;
  for (std::size_t k = 0; k < kObjectives.size(); ++k)
    if (std::any_of(outcomes.begin(), outcomes.end(),
                    [&](const SweepOutcome& o) { return o.objectives[k].has_value(); }))
      known.push_back(k);
  return known;
}

std::string front_table(SweepStore& store, const std::vector<SweepOutcome>& front,
                        const std::vector<std::size_t>& objectives) {
  std::vector<TextTable::Column> columns{{"point"}};
  for (const std::size_t k : objectives) columns.push_back({kObjectives[k].title});
  columns.push_back({"set", TextTable::Align::Left});
  TextTable table(columns);
  for (std::size_t i = 0; i < std::min(front.size(), kMostRows); ++i) {
    std::vector<std::string> cells{fmt::format("{}", front[i].point)};
    for (const std::size_t k : objectives)
      cells.push_back(front[i].objectives[k]
                          ? fmt::format("{:.{}f}", *front[i].objectives[k] * kObjectives[k].scale,
                                        kObjectives[k].decimals)
                          : "-");
    cells.push_back(store.settings_of(front[i].point));
    table.add(std::move(cells));
  }
  std::string text = table.str();
  if (front.size() > kMostRows)
    text += fmt::format("  and {} more: table front of sweep.sqlite\n", front.size() - kMostRows);
  return text;
}

std::string failures(SweepStore& store, const std::vector<SweepOutcome>& outcomes) {
  std::string text;
  std::size_t count = 0;
  for (const SweepOutcome& o : outcomes) {
    if (o.failure.empty()) continue;
    if (++count <= kMostFailures)
      text += fmt::format("  point {} ({}): {}\n", o.point, printable(store.settings_of(o.point)),
                          printable(o.failure));
  }
  if (count > kMostFailures) text += fmt::format("  and {} more\n", count - kMostFailures);
  return count == 0 ? text : fmt::format("{} of the points cannot run:\n{}", count, text);
}

}  // namespace

std::string sweep_report(SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  const std::vector<SweepOutcome> front = pareto_front(outcomes);
  const std::int64_t planned = store.planned();
  const auto open = planned - static_cast<std::int64_t>(outcomes.size());
  std::string text = fmt::format("{} of {} points are done", outcomes.size(), planned);
  text += open > 0 ? fmt::format(", {} are open\n", open) : std::string("\n");
  text += failures(store, outcomes);
  if (front.empty()) return text;
  const std::vector<std::size_t> known = known_objectives(front);
  text +=
      fmt::format("\nPareto front, {} of them: no other point is better in one of\n", front.size());
  for (std::size_t i = 0; i < known.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", kObjectives[known[i]].title);
  return text + " and as good in the others\n" + front_table(store, front, known);
}

}  // namespace leviosim::tools
