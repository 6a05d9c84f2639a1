#include "tools/app/history/history_report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/history/history.h"
#include "tools/app/history/trends.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFrameCycles = "frame.cycles.parallel.mean";
/// Runs of a page at most, and distinct stages of which it says where their cycles went.
constexpr std::size_t kMostRuns = 1000;
constexpr std::size_t kNewest = 100;
constexpr std::size_t kMostStages = 400;

std::string change_text(const std::optional<double>& before, const std::optional<double>& now) {
  if (!before || !now || *before == 0) return kNothing;
  const double percent = 100 * (*now - *before) / *before;
  return percent == 0 ? "0" : fmt::format("{:+.2f} %", percent);
}

std::string limits_text(const LimitsThen& limits) {
  if (limits.held == 0) return kNothing;
  if (limits.missed.empty()) return "met";
  return fmt::format("{} not met", limits.missed.size());
}

bool is_same(const RunRecord& a, const RunRecord& b) {
  return std::equal(a.statistics.begin(), a.statistics.end(), b.statistics.begin(),
                    b.statistics.end(), [](const Statistic& x, const Statistic& y) {
                      return x.name == y.name && x.value == y.value;
                    });
}

/// A figure that a page draws.
struct PageFigure {
  std::string statistic;
  std::string title;
  std::string unit;
  double scale = 1;  ///< from the statistic's unit
};

/// Those in which something was found, and those of the run that changed.
std::vector<PageFigure> figures_of_page(const std::vector<Trend>& trends,
                                        const std::vector<const PastRun*>& runs) {
  constexpr std::size_t kMost = 40;
  std::vector<PageFigure> figures;
  for (const Trend& trend : trends) {
    if ((trend.steps.empty() && trend.drift.empty()) || figures.size() == kMost) continue;
    const ShownUnit shown = shown_unit(trend.unit);
    std::string title =
        trend.stage.empty() ? trend.limit->figure : trend.stage + ": " + trend.limit->figure;
    figures.push_back({trend.statistic, std::move(title), std::string(shown.name), 1 / shown.size});
  }
  for (const FigureRow& q : figure_rows()) {
    if (q.title.empty()) continue;
    std::erase_if(figures, [&](const PageFigure& f) { return f.statistic == q.statistic; });
    const auto first = runs.front()->record.value(q.statistic);
    const bool has_changed = std::any_of(runs.begin(), runs.end(), [&](const PastRun* run) {
      return run->record.value(q.statistic) != first;
    });
    if (has_changed || q.statistic == kFrameCycles)
      figures.push_back(
          {std::string(q.statistic), std::string(q.title), std::string(q.title_unit), q.scale});
  }
  return figures;
}

std::string title_of(const Trend& trend) {
  return trend.limit->stage.empty() ? trend.limit->text : trend.stage + ": " + trend.limit->text;
}

/// By how much its largest change was for the worse, in per cent.
double worst_of(const Trend& trend) {
  double worst = trend.drift.empty() ? 0 : trend.drift_percent;
  for (const FigureChange& step : trend.steps) worst = std::max(worst, step.percent);
  return worst;
}

std::string trend_lines(const std::vector<PastRun>& runs, const Budget& budget) {
  std::string text;
  for (const Trend& trend : trends(budget, runs)) {
    const std::string title = title_of(trend);
    for (const FigureChange& step : trend.steps)
      text += fmt::format("{}: {}\n", printable(title), printable(step_text(trend, step, runs)));
    if (!trend.drift.empty())
      text += fmt::format("{}: {}\n", printable(title), printable(drift_text(trend, runs)));
  }
  return text;
}

std::string conclusion_of(const std::vector<PastRun>& runs) {
  std::size_t changed = 0;
  for (std::size_t i = 1; i < runs.size(); ++i)
    changed += !is_same(runs[i - 1].record, runs[i].record);
  return fmt::format(
      "in short: {} runs, {} of which changed something; cycles of a frame {} in all", runs.size(),
      changed,
      change_text(runs.front().record.value(kFrameCycles), runs.back().record.value(kFrameCycles)));
}

/// Those of which a page has room.
std::vector<const PastRun*> shown_runs(const std::vector<PastRun>& runs) {
  std::vector<const PastRun*> shown;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (i == 0 || i + kNewest >= runs.size() || !is_same(runs[i - 1].record, runs[i].record))
      shown.push_back(&runs[i]);
  if (shown.size() > kMostRuns)
    shown.erase(shown.begin(), shown.end() - static_cast<std::ptrdiff_t>(kMostRuns));
  return shown;
}

/// kcycles of a mean frame: of the stage, and of its parts in words.
Json stage_json(const StageParts& stage, double frames) {
  Json parts = Json::object();
  for (const CyclePart& part : stage.parts) {
    std::string name = part.where.empty() ? std::string() : part.where + ": ";
    const std::string label = part_label(part.mechanism);
    name += label;
    if (!label.ends_with(part.operation)) name += " (" + part.operation + ')';
    parts[name] = parts.value(name, 0.0) + rounded(part.cycles / frames / 1e3).get<double>();
  }
  return {{"name", stage.stage},
          {"kcycles", rounded(stage.cycles / frames / 1e3)},
          {"parts", std::move(parts)}};
}

/// The runs with indices of their stages, each of which stands once.
Json runs_json(const std::vector<const PastRun*>& runs) {
  Json history{{"runs", Json::array()}, {"stages", Json::array()}};
  std::map<std::string, std::size_t> known;
  std::vector<Json> newest_first;
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    const RunRecord& record = (*run)->record;
    const double frames = std::max(1.0, record.value("frames.count").value_or(1));
    Json stages = Json::array();
    for (const StageParts& stage : record.cycles) {
      Json json = stage_json(stage, frames);
      const auto [at, is_new] = known.emplace(json_text(json), known.size());
      if (is_new && known.size() <= kMostStages) history["stages"].push_back(std::move(json));
      stages.push_back(at->second);
    }
    newest_first.push_back({{"commit", record.name},
                            {"subject", (*run)->origin.subject},
                            {"stages", std::move(stages)}});
  }
  history["runs"] = Json(std::vector<Json>(newest_first.rbegin(), newest_first.rend()));
  history["from"] = 0;
  history["to"] = runs.size() - 1;
  return history;
}

/// Limits of the budget on figures of the run, in the units of the page: absolute ones, and those
/// relative to the first of the runs.
std::map<std::string, double> limits_of(const Budget& budget,
                                        const std::vector<PageFigure>& figures,
                                        const RunRecord& first, const RunRecord& last) {
  std::map<std::string, double> limits;
  for (const BudgetSection* section : sections_for(budget, last))
    for (const Limit& limit : section->limits)
      for (const FigureOf& figure : find_figures(limit, last))
        for (const PageFigure& q : figures) {
          if (figure.statistic->name != q.statistic) continue;
          const double bound = bound_in(limit, figure.statistic->unit);
          const auto base = first.value(q.statistic);
          if (!limit.bound.relative)
            limits[q.statistic] = bound * q.scale;
          else if (base && is_percent_of_baseline(limit.bound))
            limits[q.statistic] = *base * (1 + bound / 100) * q.scale;
        }
  return limits;
}

/// The points of the page: a row a run; columns are named as the statistics are.
void show_points(const std::vector<const PastRun*>& runs, const std::vector<PageFigure>& figures,
                 StudyPage& page) {
  struct Row {
    std::size_t number;
    const PastRun& run;
  };
  using R = const Row&;
  Columns<Row> table{
      {{.title = "commits", .key = "run", .is_setup = true}, [](R r) { return r.number; }},
      {{.title = "commit", .key = "commit", .is_setup = true},
       [](R r) { return r.run.record.name; }},
      {{.title = "subject", .key = "subject", .is_setup = true},
       [](R r) { return r.run.origin.subject; }},
      {{.title = "date", .key = "date", .is_setup = true},
       [](R r) { return date_text(r.run.origin.time_s); }},
      {{.title = "limits", .key = "limits"}, [](R r) { return limits_text(r.run.limits); }}};
  for (const PageFigure& q : figures)
    table.push_back(
        {{.title = q.title, .key = q.statistic, .decimals = 6, .unit = q.unit, .scale = q.scale},
         [&q](R r) { return r.run.record.value(q.statistic); }});
  std::vector<Row> rows;
  for (const PastRun* run : runs) rows.push_back({rows.size(), *run});
  page.points = table_of(table, rows);
}

/// Of each figure with steps, those runs of the page that made them.
std::map<std::string, std::vector<std::size_t>> marks_of(const std::vector<Trend>& trends,
                                                         const std::vector<PastRun>& runs,
                                                         const std::vector<const PastRun*>& shown) {
  std::map<std::string, std::vector<std::size_t>> marks;
  for (const Trend& trend : trends)
    for (const FigureChange& step : trend.steps)
      if (const auto at = std::find(shown.begin(), shown.end(), &runs[step.run]); at != shown.end())
        marks[trend.statistic].push_back(static_cast<std::size_t>(at - shown.begin()));
  return marks;
}

/// The steps of a figure, and its drift. Lines of a long history would fill the page.
StudyBox box_of(const Trend& trend, const std::vector<PastRun>& runs) {
  constexpr std::size_t kMost = 4;
  StudyBox box;
  box.good = false;
  box.mark = title_of(trend);
  const std::size_t count = trend.steps.size();
  box.sentence = fmt::format("{}{}",
                             count == 0   ? "A drift"
                             : count == 1 ? "A step"
                                          : fmt::format("{} steps", count),
                             trend.drift.empty() || count == 0 ? "." : " and a drift.");
  if (!trend.drift.empty()) box.lines.push_back(drift_text(trend, runs));
  for (std::size_t i = 0; i < std::min(count, kMost); ++i)
    box.lines.push_back(step_text(trend, trend.steps[count - 1 - i], runs));
  if (count > kMost) box.lines.push_back(fmt::format("and {} earlier ones", count - kMost));
  return box;
}

/// Of the figures that moved most; the others by name.
void add_boxes(StudyPage& page, const std::vector<Trend>& trends,
               const std::vector<PastRun>& runs) {
  constexpr std::size_t kMost = 4;
  std::vector<const Trend*> moved;
  for (const Trend& trend : trends)
    if (!trend.steps.empty() || !trend.drift.empty()) moved.push_back(&trend);
  std::stable_sort(moved.begin(), moved.end(),
                   [](const Trend* a, const Trend* b) { return worst_of(*a) > worst_of(*b); });
  std::vector<std::string> others;
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (i < kMost)
      page.boxes.push_back(box_of(*moved[i], runs));
    else
      others.push_back(title_of(*moved[i]));
  if (!others.empty())
    page.summary += fmt::format("\nsteps or drift also in {}", fmt::join(others, "; "));
}

}  // namespace

std::string date_text(std::int64_t time_s) {
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(static_cast<std::time_t>(time_s)));
}

Printout history_printout(const std::vector<PastRun>& runs, const Budget* budget,
                          std::vector<std::string> next) {
  using R = const PastRun* const&;
  const auto figure = [](const char* statistic, double scale, int decimals) {
    return [=](R r) { return figure_text(scaled(r->record.value(statistic), scale), decimals); };
  };
  const Columns<const PastRun*> table{
      {{"commit", kLeft}, [](R r) { return r->record.name; }},
      {{"date", kLeft, 1}, [](R r) { return date_text(r->origin.time_s); }},
      {{"kcycles of a frame"}, figure(kFrameCycles, 1e-3, 1)},
      {{"change"},
       [&](R r) {
         if (r == &runs.front()) return std::string(kNothing);
         return change_text((r - 1)->record.value(kFrameCycles), r->record.value(kFrameCycles));
       }},
      {{"p99 ms", kRight, 2}, figure("frame.latency.p99", 1e-6, 2)},
      {{"mJ", kRight, 2}, figure("energy.frame", 1, 3)},
      {{"ATE m", kRight, 3},
       [](R r) { return metres_text(r->record.value("accuracy.ate.rmse"), 3); }},
      {{"limits", kLeft, 1}, [](R r) { return limits_text(r->limits); }},
      {{"subject", kLeft}, [](R r) { return r->origin.subject; }}};
  std::vector<const PastRun*> newest_first;
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) newest_first.push_back(&*run);
  const RunFacts& facts = runs.back().record.facts;
  const std::string head =
      fmt::format("{} on {}, {} cores, {} frames; the newest run first\n", printable(facts.profile),
                  printable(facts.platform), facts.cores, facts.frames);
  return Printout({head + terminal_text(table_of(table, newest_first)),
                   budget == nullptr ? "" : trend_lines(runs, *budget)})
      .ending(conclusion_of(runs), std::move(next));
}

std::string history_document(const std::vector<PastRun>& runs) {
  Json document{{"format", "leviosim history"}, {"version", 1}, {"runs", Json::array()}};
  for (const PastRun& run : runs) {
    Json& entry = document["runs"].emplace_back(Json::object());
    entry["commit"] = run.origin.commit;
    entry["branch"] = run.origin.branch;
    entry["time"] = run.origin.time_s;
    entry["subject"] = run.origin.subject;
    entry["limits"] = run.limits.held;
    entry["missed"] = run.limits.missed;
    for (const FigureRow& q : figure_rows())
      if (!q.title.empty())
        entry["figures"][std::string(q.statistic)] = value_of(run.record.value(q.statistic));
  }
  return json_text(document, 1) + '\n';
}

std::string exported(const PastRun& run, const std::string& format) {
  Json list = Json::array();
  Json map = Json::object();
  for (const FigureRow& q : figure_rows()) {
    const auto value = run.record.value(q.statistic);
    if (!value || q.title.empty()) continue;
    const Json shown = rounded(*value * q.scale);
    list.push_back({{"name", q.title}, {"unit", q.title_unit}, {"value", shown}});
    map[std::string(q.title)][std::string(q.title_unit)]["value"] = shown;
  }
  if (format == "github-action-benchmark") return json_text(list, 1) + '\n';
  if (format == "bencher") return json_text(map, 1) + '\n';
  const std::vector<std::string> known{"github-action-benchmark", "bencher"};
  throw InputError(fmt::format("--export '{}': expected {}{}", format, fmt::join(known, " or "),
                               base::did_you_mean(format, known)));
}

Json history_page(const std::string& title, const std::vector<PastRun>& runs,
                  const Budget* budget) {
  const std::vector<const PastRun*> shown = shown_runs(runs);
  const std::vector<Trend> found = budget != nullptr ? trends(*budget, runs) : std::vector<Trend>();
  const std::vector<PageFigure> figures = figures_of_page(found, shown);
  StudyPage page;
  page.title = title;
  page.summary = conclusion_of(runs);
  add_boxes(page, found, runs);
  if (budget != nullptr)
    page.limits = limits_of(*budget, figures, runs.front().record, runs.back().record);
  show_points(shown, figures, page);
  page.curves =
      StudyCurves{"run", "", {}, "One point per run, in the order of their commits.", false};
  page.curves->names = "commit";
  page.curves->marks = marks_of(found, runs, shown);
  for (const PageFigure& q : figures) page.curves->y.emplace_back(q.statistic);
  page.x = "run";
  page.y = kFrameCycles;
  Json data = study_report(page);
  data["history"] = runs_json(shown);
  return data;
}

}  // namespace leviosim::tools
