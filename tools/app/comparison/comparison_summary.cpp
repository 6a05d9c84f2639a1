#include "tools/app/comparison/comparison_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/printable.h"
#include "tools/app/cli/screen.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/comparison/main_causes.h"
#include "tools/app/comparison/model_errors.h"
#include "tools/app/record/record.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostFigures = 6;

constexpr std::size_t kMostStages = 4;

constexpr double kPerKilo = 1e3;

std::string screen_line(const std::string& text) { return shortened(text, kScreenColumns) + '\n'; }

/// With the settings that the other run does not have. The name last, which may be long.
std::string described(std::string_view letter, const RunRecord& run, const RunRecord& other) {
  const RunFacts& f = run.facts;
  std::string text = fmt::format("{}  {}", letter, printable(f.profile)) +
                     (f.platform.empty() ? " on the host" : " on " + printable(f.platform));
  const auto add = [&](const std::vector<std::string>& sets,
                       const std::vector<std::string>& others) {
    for (const std::string& set : sets)
      if (std::find(others.begin(), others.end(), set) == others.end())
        text += ", " + printable(set);
  };
  add(f.workload, other.facts.workload);
  add(f.overrides, other.facts.overrides);
  if (f.cores > 0) text += fmt::format(", {} cores", f.cores);
  if (!f.camera.empty()) text += ", camera at " + printable(f.camera);
  return screen_line(text + ": " + printable(run.name));
}

std::string verdicts_in_words(const RunRecord& run) {
  std::string words;
  for (const RunVerdict& verdict : run.verdicts.list)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", verdict.about, verdict.word());
  return words;
}

std::string verdict_line(const RunComparison& c) {
  const std::string a = verdicts_in_words(c.a);
  const std::string b = verdicts_in_words(c.b);
  if (a == b) return screen_line("verdicts: " + a);
  return screen_line("verdicts A: " + a) + screen_line("         B: " + b);
}

/// Those that differ, in their order, after the mean frame.
std::string figure_lines(const RunComparison& c) {
  Table table({{"", kLeft}, {"A"}, {"B"}, {"unit", kLeft}, {"change"}});
  std::size_t rows = 0;
  for (const ComparedQuantity& q : c.figures) {
    const bool is_first = &q == &c.figures.front();
    if ((q.a == q.b && !is_first) || rows == kMostFigures) continue;
    ++rows;
    const int decimals = q.unit == "m" || q.unit == "mJ" ? 3 : q.unit == "ms" ? 2 : 1;
    table.add({q.name, quantity_text(q.a, q.unit, decimals), quantity_text(q.b, q.unit, decimals),
               q.unit, q.percent() ? fmt::format("{:+.1f} %", *q.percent()) : kNothing});
  }
  return terminal_text(table, kScreenColumns);
}

/// Those whose part of a frame differs most.
std::string stages_of_summary(const RunComparison& c) {
  std::vector<const ComparedQuantity*> stages;
  const auto size = [](const ComparedQuantity* q) {
    return std::abs(q->b.value_or(0) - q->a.value_or(0));
  };
  for (const ComparedQuantity& stage : c.frame.parts)
    if (size(&stage) >= 0.05 * kPerKilo) stages.push_back(&stage);
  if (stages.empty()) return {};
  std::stable_sort(stages.begin(), stages.end(),
                   [&](const auto* x, const auto* y) { return size(x) > size(y); });
  Table table({{"kcycles of a mean frame", kLeft}, {"A"}, {"B"}, {"change"}});
  for (std::size_t i = 0; i < std::min(stages.size(), kMostStages); ++i)
    table.add({shortened(stages[i]->name, 30), figure_text(*stages[i]->a / kPerKilo, 1),
               figure_text(*stages[i]->b / kPerKilo, 1),
               stages[i]->percent() ? fmt::format("{:+.1f} %", *stages[i]->percent()) : kNothing});
  return terminal_text(table, kScreenColumns);
}

/// Of a mean frame, in all stages, what passes through a memory in tiles.
double tiles_of(const RunRecord& run, std::string_view statistic) {
  double sum = 0;
  for (const StageName& stage : run.stages)
    sum += run.value(fmt::format("stages.{}.{}", stage.key, statistic)).value_or(0);
  return sum / run.value("frames.count")
                   .value_or(static_cast<double>(std::max<std::int64_t>(1, run.facts.frames)));
}

/// "tiled: 12.0 more transfers a frame, 34.1 kB"; empty if neither run has others.
std::string tiles_line(const RunComparison& c) {
  const double more = tiles_of(c.b, "tiles") - tiles_of(c.a, "tiles");
  if (more == 0) return {};
  const double bytes = tiles_of(c.b, "tile_bytes") - tiles_of(c.a, "tile_bytes");
  return screen_line(fmt::format("tiled: {:.1f} {} transfers a frame, {:.1f} kB", std::abs(more),
                                 more > 0 ? "more" : "fewer", std::abs(bytes) / kPerKilo));
}

std::vector<std::string> cause_lines(const RunComparison& c) {
  if (c.a.cycles.empty() || c.b.cycles.empty())
    return {screen_line("where the cycles of one of the runs went is not known; replay its trace")};
  std::vector<std::string> lines;
  for (const MainCause& cause : worth_naming(main_causes(timed_parts(c.a), timed_parts(c.b))))
    lines.push_back(screen_line("  " + cause_text(cause)));
  if (!lines.empty())
    lines.insert(lines.begin(), screen_line("why a mean frame takes another time:"));
  if (std::string tiles = tiles_line(c); !tiles.empty())
    lines.insert(lines.begin(), std::move(tiles));
  const std::string unused = unused_text(unused_accelerators(c.a), unused_accelerators(c.b));
  if (!unused.empty())
    lines.push_back(wrap({unused.substr(0, unused.find(", because")) + ",",
                          unused.substr(unused.find("because"))},
                         " ", 2, kScreenColumns) +
                    '\n');
  if (lines.empty()) lines.push_back(screen_line("no stage differs"));
  return lines;
}

/// "in short: B takes 41.60 ms for a mean frame, A 41.94 (-0.8 %)"
std::string conclusion(const RunComparison& c) {
  if (c.figures.empty()) return screen_line("in short: no figure is in both");
  const auto known = std::find_if(c.figures.begin(), c.figures.end(),
                                  [](const ComparedQuantity& q) { return q.a && q.b; });
  if (known == c.figures.end()) return screen_line("in short: no figure is in both");
  const ComparedQuantity& first = *known;
  const int decimals = first.unit == "ms" ? 2 : 3;
  return screen_line(
      fmt::format("in short: {}: A {}, B {} {}{}", first.name, figure_text(first.a, decimals),
                  figure_text(first.b, decimals), first.unit,
                  first.percent() ? fmt::format(" ({:+.1f} %)", *first.percent()) : ""));
}

}  // namespace

std::string comparison_summary(const RunComparison& c) {
  if (c.a.facts.measured || c.b.facts.measured) return measured_report(c, false);
  std::string text = described("A", c.a, c.b) + described("B", c.b, c.a);
  for (const std::string& note : c.notes) text += screen_line("note: " + printable(note));
  text += screen_line(work_line(c)) + verdict_line(c) + figure_lines(c) + stages_of_summary(c);
  const auto count = [](const std::string& of) {
    return static_cast<int>(std::count(of.begin(), of.end(), '\n'));
  };
  const std::string end =
      conclusion(c) + "next: the same with --all, or with --report compare.html\n";
  for (const std::string& cause : cause_lines(c))
    if (count(text) + count(cause) + count(end) <= kScreenLines) text += cause;
  return text + end;
}

}  // namespace leviosim::tools
