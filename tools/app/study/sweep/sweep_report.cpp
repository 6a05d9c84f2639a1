#include "tools/app/study/sweep/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "sim/base/printable_text.h"
#include "tools/app/report/text_table.h"

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

/// Titles, then a row for each of the first `most` points.
std::vector<std::vector<std::string>> front_cells(SweepStore& store,
                                                  const std::vector<SweepOutcome>& front,
                                                  const std::vector<std::size_t>& objectives,
                                                  std::size_t most) {
  std::vector<std::vector<std::string>> rows(1);
  rows[0].push_back("point");
  for (const std::size_t k : objectives) rows[0].emplace_back(kObjectives[k].title);
  rows[0].push_back("set");
  for (std::size_t i = 0; i < std::min(front.size(), most); ++i) {
    std::vector<std::string> cells{fmt::format("{}", front[i].point)};
    for (const std::size_t k : objectives)
      cells.push_back(front[i].objectives[k]
                          ? fmt::format("{:.{}f}", *front[i].objectives[k] * kObjectives[k].scale,
                                        kObjectives[k].decimals)
                          : "-");
    cells.push_back(store.settings_of(front[i].point));
    rows.push_back(std::move(cells));
  }
  return rows;
}

std::string front_table(SweepStore& store, const std::vector<SweepOutcome>& front,
                        const std::vector<std::size_t>& objectives) {
  const auto rows = front_cells(store, front, objectives, kMostRows);
  std::vector<TextTable::Column> columns;
  for (const std::string& title : rows[0]) columns.push_back({title});
  columns.back().align = TextTable::Align::Left;
  TextTable table(columns);
  for (std::size_t i = 1; i < rows.size(); ++i) table.add(rows[i]);
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

std::vector<std::vector<std::string>> sweep_front(SweepStore& store) {
  const std::vector<SweepOutcome> front = pareto_front(store.outcomes());
  if (front.empty()) return {};
  return front_cells(store, front, known_objectives(front), front.size());
}

StudyBox sweep_box(SweepStore& store) {
  const std::vector<SweepOutcome> outcomes = store.outcomes();
  const std::int64_t planned = store.planned();
  const auto done = static_cast<std::int64_t>(outcomes.size());
  StudyBox box;
  box.good = done == planned;
  box.mark = fmt::format("{} of {} points are done", done, planned);
  for (const SweepOutcome& o : outcomes) {
    if (o.failure.empty()) continue;
    box.good = false;
    box.lines.push_back(
        fmt::format("point {} ({}): {}", o.point, store.settings_of(o.point), o.failure));
  }
  box.sentence = fmt::format("{} of them cannot run, and no other point beats {}.",
                             box.lines.size(), pareto_front(outcomes).size());
  if (box.lines.size() > kMostFailures) {
    box.lines.resize(kMostFailures);
    box.lines.push_back("and more: column failure of the points");
  }
  return box;
}

std::string sweep_conclusion(SweepStore& store) {
  const StudyBox box = sweep_box(store);
  if (box.lines.empty()) return fmt::format("in short: {}; {}", box.mark, box.sentence);
  return fmt::format("verdict: {}; {}", box.lines.front(), box.sentence);
}

std::vector<std::string> after_sweep(SweepStore& store, const std::string& folder) {
  for (const SweepOutcome& best : pareto_front(store.outcomes()))
    if (best.point != 1)
      return {fmt::format("leviosim compare {0}:1 {0}:{1}", printable(folder), best.point)};
  return {};
}

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

namespace {

using Values = std::array<double, kObjectives.size()>;

Values values_of(const SweepOutcome& outcome) {
  Values values{};
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = outcome.objectives[k].value_or(std::numeric_limits<double>::infinity());
  return values;
}

bool dominates(const Values& a, const Values& b) {
  bool better = false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] > b[k]) return false;
    better = better || a[k] < b[k];
  }
  return better;
}

}  // namespace

bool dominates(const SweepOutcome& a, const SweepOutcome& b) {
  return dominates(values_of(a), values_of(b));
}

std::vector<SweepOutcome> pareto_front(const std::vector<SweepOutcome>& outcomes) {
  struct Candidate {
    Values values;
    const SweepOutcome* outcome;
  };
  std::vector<Candidate> sorted;
  for (const SweepOutcome& o : outcomes)
    if (o.failure.empty()) sorted.push_back({values_of(o), &o});
  std::sort(sorted.begin(), sorted.end(), [](const Candidate& a, const Candidate& b) {
    return a.values != b.values ? a.values < b.values : a.outcome->point < b.outcome->point;
  });
  // What dominates a point comes before it, and if that is dominated itself, so does what is on the
  // front: each has to be compared with the front so far only.
  std::vector<Candidate> front;
  for (const Candidate& c : sorted)
    if (std::none_of(front.begin(), front.end(),
                     [&](const Candidate& f) { return dominates(f.values, c.values); }))
      front.push_back(c);
  std::vector<SweepOutcome> result;
  for (const Candidate& c : front) result.push_back(*c.outcome);
  return result;
}

namespace {

/// "platform.cluster.clock" → "cluster.clock".
std::string title_of(const std::string& parameter) {
  constexpr std::string_view kPlatform = "platform.";
  return parameter.rfind(kPlatform, 0) == 0 ? parameter.substr(kPlatform.size()) : parameter;
}

}  // namespace

Json sweep_page(SweepStore& store) {
  constexpr double kNsToMs = 1e-6;
  const std::vector<std::string> parameters = store.parameter_names();
  StudyPage page;
  page.title = "A sweep";
  page.boxes = {sweep_box(store)};
  page.best = sweep_front(store);
  page.points = store.csv();
  page.columns = {{"point", "point", "", true}};
  for (const std::string& name : parameters)
    page.columns.push_back({name, title_of(name), "", true});
  const std::vector<StudyColumn> figures{
      {"objective.frame_time", "mean frame", "ms"},
      {"objective.energy", "energy per frame", "mJ"},
      {"objective.l1_peak", "L1 peak", "kB", false, false, 1e-3},
      {"objective.ate", "position error (ATE)", "m"},
      {"objective.area", "area", "mm2"},
      {"latency.all.p50", "median latency", "ms", false, false, kNsToMs},
      {"latency.all.p99", "latency of 99 %", "ms", false, false, kNsToMs},
      {"latency.all.worst", "worst latency", "ms", false, false, kNsToMs},
      {"camera.missed_share", "missed frames", "%", false, false, 100},
      {"energy.mean_power", "mean power", "mW"},
      {"energy.front_end_power", "power of the front end", "mW"},
      {"accuracy.completion", "completion", "%", false, true, 100},
      {"failure", "failure", ""}};
  page.columns.insert(page.columns.end(), figures.begin(), figures.end());
  if (!parameters.empty() && parameters.size() <= 2)
    page.curves = {parameters.front(),
                   parameters.size() == 2 ? parameters.back() : std::string(),
                   {"objective.frame_time", "objective.energy", "objective.l1_peak",
                    "objective.ate", "objective.area"}};
  page.x = "objective.frame_time";
  page.y = "objective.energy";
  page.colour = parameters.size() > 1 ? parameters.back() : std::string();
  return study_report(page);
}

}  // namespace leviosim::tools
