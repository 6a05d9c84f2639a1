#include "tools/app/study/sweep/sweep_check.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/figures.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/workload.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostMisses = 40;

std::vector<StageName> stages_of(const ResolvedPoint& point) {
  std::vector<StageName> stages;
  const auto add = [&](const std::string& name, bool on_controller) {
    stages.push_back({name, key_of(name), on_controller});
  };
  if (point.trace != nullptr)
    for (const auto& stage : point.trace->info().stages) add(stage.name, stage.on_controller);
  else
    for (const auto& stage : stages_of(point.request))
      add(std::string(stage.name), stage.on_controller);
  return stages;
}

/// What limits are mostly about and the point has no value of, such as cycles of a stage that was
/// never called: an outcome does not list it.
void add_missing(RunRecord& record) {
  const auto add = [&](const FigurePhrase& phrase, const std::string& name) {
    if (record.find(name) == nullptr)
      record.statistics.push_back({.name = name, .unit = std::string(phrase.unit)});
  };
  for (const FigurePhrase& phrase : run_phrases()) add(phrase, std::string(phrase.statistic));
  for (const StageName& stage : record.stages)
    for (const FigurePhrase& phrase : stage_phrases())
      add(phrase, fmt::format(fmt::runtime(phrase.statistic), stage.key));
}

/// A limit that a point does not meet, or why it has no figures.
struct Miss {
  std::string limit;
  std::string found;
};

std::optional<Miss> first_miss(const CheckResult& result) {
  for (const Finding& finding : result.findings) {
    if (finding.met) continue;
    Miss miss{finding.title(), finding.excess()};
    if (result.missed() > 1) miss.limit += fmt::format(" (and {} more)", result.missed() - 1);
    return miss;
  }
  return std::nullopt;
}

/// The record of a finished point: what sections and limits of a budget ask for.
RunRecord point_record(const ResolvedPoint& point, const SweepRow& settings, int number,
                       RunRecord record) {
  record.name = fmt::format("point {}", number);
  const auto platform = settings.find("platform");
  const bool recorded = point.trace != nullptr;
  record.facts.profile = recorded ? point.trace->info().profile : point.request.profile;
  record.facts.platform = platform != settings.end() ? platform->second
                          : recorded                 ? point.trace->info().platform
                                                     : point.request.platform.name;
  record.facts.overrides = point.overrides;
  record.facts.cores = point.request.cores;
  record.stages = stages_of(point);
  add_missing(record);
  return record;
}

}  // namespace

SweepCheck check_sweep(const Budget& budget, const SweepPlan& plan,
                       const std::vector<SweepPoint>& points, SweepInputs& inputs,
                       SweepStore& store) {
  SweepCheck check;
  std::optional<RunRecord> first;
  Table table({{"point"}, {"limit", kLeft}, {"found", kLeft}, {"set", kLeft}});
  for (std::size_t i = 0; i < points.size(); ++i) {
    throw_if_interrupted();
    const int number = static_cast<int>(i) + 1;
    std::optional<RunRecord> outcome = store.result_of(number);
    if (!outcome) continue;
    ++check.held;
    std::optional<Miss> miss;
    if (outcome->failure.empty()) {
      const SweepRow settings = points[i].settings;
      RunRecord record = point_record(resolve(plan, settings, inputs, plan.file), settings, number,
                                      std::move(*outcome));
      if (i == 0) first = record;
      miss = first_miss(check_budget(record, budget, first ? &*first : nullptr));
    } else {
      miss = Miss{"cannot run", outcome->failure};
    }
    if (!miss) continue;
    if (check.missed == 0)
      check.verdict = fmt::format("point {}: {}: {}", number, miss->limit, miss->found);
    if (++check.missed <= kMostMisses)
      table.add({fmt::format("{}", number), miss->limit, miss->found, points[i].settings_text()});
  }
  check.text = fmt::format("{} points against {}: {} do not meet it\n", check.held,
                           printable(budget.file), check.missed);
  check.verdict = check.missed == 0
                      ? fmt::format("verdict: met: all {} points meet {}", check.held, budget.file)
                      : fmt::format("verdict: NOT met by {} of {} points, first {}", check.missed,
                                    check.held, check.verdict);
  if (check.missed > 0) check.text += terminal_text(table);
  if (check.missed > kMostMisses)
    check.text += fmt::format("  and {} more\n", check.missed - kMostMisses);
  return check;
}

}  // namespace leviosim::tools
