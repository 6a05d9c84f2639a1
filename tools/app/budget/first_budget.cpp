#include "tools/app/budget/first_budget.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/error.h"

namespace leviosim::tools {
namespace {

struct FirstLimit {
  const char* figure;
  const char* statistic;
  double scale;  ///< from the statistic's unit
  const char* unit;
  int decimals;
};

constexpr std::array kFirstLimits{
    FirstLimit{"frame time p99", "frame.time.p99", 1e-6, "ms", 2},
    FirstLimit{"missed", "frame.missed_share", 100, "%", 2},
    FirstLimit{"frame cycles", "frame.cycles.parallel.mean", 1e-3, "kcycles", 1},
    FirstLimit{"L1 peak", "memory.l1.peak", 1e-3, "kB", 1},
    FirstLimit{"L2 peak", "memory.l2.peak", 1e-3, "kB", 1},
    FirstLimit{"energy per frame", "energy.frame", 1, "mJ", 4},
    FirstLimit{"ATE", "accuracy.ate.rmse", 1, "m", 4},
};

/// Not below the value, though it is rounded.
std::string rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  // A share of what is exact as written must not grow by a digit; no negative zero.
  const double digits = std::max(0.0, std::ceil(value * scale - 1e-6));
  return fmt::format("{:.{}f}", digits / scale, decimals);
}

}  // namespace

std::string first_budget(const RunRecord& run, double margin) {
  const double factor = 1 + margin / 100;
  const auto quoted = [](const std::string& text) { return json_text(Json(text)); };
  std::string text = fmt::format(
      "# What the run needs, and {:g} % more. Give each limit its reason and owner.\n"
      "budgets:\n  - name: {}\n    platform: {}\n    profile: {}\n    limits:\n",
      margin, quoted(run.facts.profile + " on " + run.facts.platform), quoted(run.facts.platform),
      quoted(run.facts.profile));
  for (const FirstLimit& limit : kFirstLimits)
    if (const auto value = run.value(limit.statistic))
      text += fmt::format("      - {} <= {} {}\n", limit.figure,
                          rounded_up(*value * limit.scale * factor, limit.decimals), limit.unit);
  for (const RunVerdict& verdict : run.verdicts.list)  // a budget that says nothing refuses these
    if (verdict.grade == Grade::bad)
      text += fmt::format("      - {} verdict <= {}\n", verdict.about, verdict.word());
  for (const StageName& stage : run.stages)
    if (const auto value = run.value(fmt::format("stages.{}.cycles.parallel.mean", stage.key)))
      text += fmt::format("      - stage: {}\n        limit: cycles <= {} kcycles\n",
                          quoted(stage.name), rounded_up(*value * 1e-3 * factor, 1));
  return text;
}

double parse_share(const std::string& option, const std::string& text) {
  const auto measure = platform::split_measure(text);
  if (!measure || measure->unit != "%" || !(measure->number >= 0 && measure->number <= 1000))
    throw InputError(
        fmt::format("{} '{}': expected a share from 0 to 1000 %, such as 5 %", option, text));
  return measure->number;
}

}  // namespace leviosim::tools
