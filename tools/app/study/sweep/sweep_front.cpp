#include "tools/app/study/sweep/sweep_front.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

#include "platform_models/loader/parameter_units.h"
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/sweep_key.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostRows = 40;
constexpr std::size_t kTime = 0;    ///< among kObjectives
constexpr std::size_t kEnergy = 1;  ///< among kObjectives

std::string shown(const SweepOutcome& outcome, std::size_t k) {
  const std::optional<double>& value = outcome.objectives[k];
  if (!value) return "-";
  if (kObjectives[k].shown_unit == std::string_view("m"))
    return metres_text(*value, kObjectives[k].decimals);
  return fmt::format("{:.{}f}", *value * kObjectives[k].scale, kObjectives[k].decimals);
}

/// "frame ms".
std::string column_title(const Objective& objective) {
  return fmt::format("{} {}", objective.title, objective.shown_unit);
}

std::string value_of(const SweepStore& store, int point, const std::string& key) {
  for (const auto& [name, value] : store.settings(point))
    if (name == key) return readable_setting(value);
  return "-";
}

/// Parts of a path between dots that all paths begin with, with the last dot; each keeps two parts.
std::size_t common_prefix(const std::vector<std::string>& paths) {
  std::size_t common = std::string::npos;
  for (const std::string& path : paths) {
    const std::size_t last = path.rfind('.');
    const std::size_t before =
        last == std::string::npos || last == 0 ? last : path.rfind('.', last - 1);
    std::size_t most = before == std::string::npos ? 0 : before + 1;
    while (most > 0 && path.compare(0, most, paths.front(), 0, most) != 0) {
      const std::size_t dot = most < 2 ? std::string::npos : path.rfind('.', most - 2);
      most = dot == std::string::npos ? 0 : dot + 1;
    }
    common = std::min(common, most);
  }
  return common == std::string::npos ? 0 : common;
}

/// A front with the columns that differ among its points.
struct Front {
  std::vector<SweepOutcome> points;
  std::vector<std::string> keys;        ///< that vary
  std::vector<std::string> titles;      ///< of the keys
  std::vector<std::size_t> objectives;  ///< that vary, or are of the first two
  std::vector<std::string> common;      ///< "L1 peak kB 107.5"
};

Front front_of(const SweepStore& store) {
  Front front;
  front.points = pareto_front(store.outcomes());
  for (const std::string& key : store.parameter_names()) {
    std::set<std::string> values;
    for (const SweepOutcome& o : front.points) values.insert(value_of(store, o.point, key));
    if (values.size() > 1) front.keys.push_back(key);
  }
  const std::size_t prefix = common_prefix(front.keys);
  for (const std::string& key : front.keys) front.titles.push_back(key.substr(prefix));
  for (std::size_t k = 0; k < kObjectives.size(); ++k) {
    std::set<std::string> values;
    for (const SweepOutcome& o : front.points) values.insert(shown(o, k));
    if (values.size() > 1)
      front.objectives.push_back(k);
    else if (!values.empty() && *values.begin() != "-")
      front.common.push_back(fmt::format("{} {}", column_title(kObjectives[k]), *values.begin()));
  }
  return front;
}

/// At most so many rows.
Table front_table(const SweepStore& store, const Front& front, std::size_t most) {
  std::vector<Head> heads{{"point"}};
  for (const std::string& title : front.titles) heads.push_back({.title = title});
  // Where the width is short, the last objectives go first, and what was set stays.
  for (const std::size_t k : front.objectives)
    heads.push_back({.title = column_title(kObjectives[k]), .rank = static_cast<int>(k) + 1});
  Table table(heads);
  for (std::size_t i = 0; i < std::min(front.points.size(), most); ++i) {
    const SweepOutcome& outcome = front.points[i];
    std::vector<Cell> cells{outcome.point};
    for (const std::string& key : front.keys) cells.push_back(value_of(store, outcome.point, key));
    for (const std::size_t k : front.objectives) cells.push_back(shown(outcome, k));
    table.add(std::move(cells));
  }
  return table;
}

/// "point 6 (fpu.units=4 refill_width=16)".
std::string name_of(const SweepStore& store, const Front& front, int point) {
  std::string settings;
  for (std::size_t i = 0; i < front.keys.size(); ++i)
    settings += fmt::format("{}{}={}", i == 0 ? "" : " ", front.titles[i],
                            value_of(store, point, front.keys[i]));
  return settings.empty() ? fmt::format("point {}", point)
                          : fmt::format("point {} ({})", point, settings);
}

const SweepOutcome* best_of(const std::vector<SweepOutcome>& outcomes, std::size_t k) {
  const SweepOutcome* best = nullptr;
  for (const SweepOutcome& o : outcomes)
    if (o.objectives[k] && (best == nullptr || *o.objectives[k] < *best->objectives[k])) best = &o;
  return best;
}

/// ", -2.6 % of point 1"; nothing of point 1 itself.
std::string beside_first(const std::vector<SweepOutcome>& outcomes, const SweepOutcome& best,
                         std::size_t k) {
  if (best.point == 1 || outcomes.front().point != 1) return {};
  const std::optional<double>& first = outcomes.front().objectives[k];
  if (!first || *first == 0) return {};
  return fmt::format(", {:+.1f} % beside point 1", 100 * (*best.objectives[k] / *first - 1));
}

}  // namespace

std::string readable_setting(const std::string& value) {
  const auto measure = platform::split_measure(value);
  const std::string count = without_count_unit(value);
  if (!measure || measure->unit.empty() || count != value) return count;
  return fmt::format("{} {}", value.substr(0, value.find_first_not_of("+-.0123456789eE")),
                     measure->unit);
}

Table sweep_front(const SweepStore& store) {
  const Front front = front_of(store);
  return front_table(store, front, front.points.size());
}

std::string front_text(const SweepStore& store) {
  const Front front = front_of(store);
  if (front.points.empty()) return {};
  std::string text = fmt::format(
      "Pareto front, {} of them: no other point is better in one column and as good in all "
      "others\n",
      front.points.size());
  text += terminal_text(front_table(store, front, kMostRows));
  if (front.points.size() > kMostRows)
    text += fmt::format("  and {} more: rows of sweep.csv\n", front.points.size() - kMostRows);
  if (!front.common.empty())
    text += fmt::format("all of them: {}\n", fmt::join(front.common, ", "));
  return text;
}

std::string sweep_conclusion(const SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  const auto open = store.planned() - static_cast<std::int64_t>(outcomes.size());
  const auto failed = std::count_if(outcomes.begin(), outcomes.end(),
                                    [](const SweepOutcome& o) { return !o.failure.empty(); });
  const Front front = front_of(store);
  std::string text;
  if (const SweepOutcome* fastest = best_of(front.points, kTime)) {
    text =
        fmt::format("{} is the fastest, {:.2f} ms a frame{}", name_of(store, front, fastest->point),
                    *fastest->objectives[kTime], beside_first(outcomes, *fastest, kTime));
    const SweepOutcome* least = best_of(front.points, kEnergy);
    if (least != nullptr && least->point == fastest->point)
      text += ", and takes the least energy";
    else if (least != nullptr)
      text += fmt::format("; {} takes the least energy, {:.3f} mJ{}",
                          name_of(store, front, least->point), *least->objectives[kEnergy],
                          beside_first(outcomes, *least, kEnergy));
  } else {
    text = "no point can run";
  }
  if (failed > 0 && !front.points.empty())
    text += fmt::format("; {} of {} points cannot run", failed, outcomes.size());
  if (open > 0) text += fmt::format("; {} of {} points are open", open, store.planned());
  return text;
}

}  // namespace leviosim::tools
