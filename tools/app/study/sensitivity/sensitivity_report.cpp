#include "tools/app/study/sensitivity/sensitivity_report.h"

#include <fmt/format.h>

#include <array>

#include "sim/base/csv_table.h"
#include "tools/app/report/text_table.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

constexpr double kShown = 0.005;  ///< per cent; below, 0.00 would be printed
constexpr int kWidth = 100;

struct TimeColumn {
  const char* title;
  const char* key;
  std::optional<double> MeanTimes::*of;
};
constexpr std::array kColumns{
    TimeColumn{"frame", "frame", &MeanTimes::frame},
    TimeColumn{"EPnP", "epnp", &MeanTimes::epnp},
    TimeColumn{"8-point", "eight_point", &MeanTimes::eight_point},
    TimeColumn{"optimiser", "iteration", &MeanTimes::iteration},
};

std::string ms(std::optional<double> value) {
  return value ? fmt::format("{:.3f} ms", *value) : "–";
}

/// "-1.2 … +3.4", what the ends of the range do.
std::string change_text(const Swing& swing, const MeanTimes& base,
                        std::optional<double> MeanTimes::*of) {
  const auto low = percent_change(swing.low.*of, base.*of);
  const auto high = percent_change(swing.high.*of, base.*of);
  if (!low || !high) return "–";
  return fmt::format("{:+.2f} … {:+.2f}", *low, *high);
}

std::string list_line(const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return title + "\n  " + wrap(names, ", ", 2, kWidth) + '\n';
}

std::string bands_table(const Sensitivity& sensitivity) {
  TextTable table({{"stage", kLeft}, {"kcycles"}, {"band"}, {"per cent"}});
  for (const auto& [stage, band] : stage_bands(sensitivity))
    table.add({stage, fmt::format("{:.1f}", band.value),
               fmt::format("{:.1f} … {:.1f}", band.low, band.high),
               fmt::format("{:+.1f} … {:+.1f}", percent_change(band.low, band.value).value_or(0),
                           percent_change(band.high, band.value).value_or(0))});
  return "\na mean call of each stage if all these numbers are uncertain at once (root of the sum "
         "of\n"
         "squares; of what compilers make of operations, the factors of all together)\n" +
         table.str();
}

}  // namespace

std::string sensitivity_conclusion(const Sensitivity& sensitivity) {
  if (sensitivity.swings.empty()) return "in short: no number of this chip has a range";
  const Swing& swing = sensitivity.swings.front();
  return fmt::format(
      "in short: {} has the largest effect: {} % of the front end between {:g} and {:g} {}",
      swing.parameter.path, change_text(swing, sensitivity.base, &MeanTimes::frame),
      swing.parameter.range->low, swing.parameter.range->high, swing.parameter.unit);
}

std::vector<std::string> sensitivity_tables(const Sensitivity& sensitivity, int workers) {
  std::vector<TextTable::Column> columns{
      {"number", kLeft}, {"confidence", kLeft, 2}, {"value"}, {"range", kLeft, 1}};
  for (const TimeColumn& column : kColumns) columns.push_back({column.title});
  TextTable table(std::move(columns));
  std::vector<std::string> without_effect;
  for (const Swing& swing : sensitivity.swings) {
    const platform::Parameter& p = swing.parameter;
    if (effect_on_frame(swing, sensitivity.base) < kShown &&
        effect_on_iteration(swing, sensitivity.base) < kShown) {
      without_effect.push_back(p.path);
      continue;
    }
    std::vector<std::string> cells{p.path, p.confidence, fmt::format("{} {}", p.value, p.unit),
                                   fmt::format("{:g} … {:g}", p.range->low, p.range->high)};
    for (const TimeColumn& column : kColumns)
      cells.push_back(change_text(swing, sensitivity.base, column.of));
    table.add(std::move(cells));
  }
  const MeanTimes& base = sensitivity.base;
  return {fmt::format(
             "mean times with all numbers as they are: front end {} on {} cores (EPnP {}, 8-point "
             "{}), optimiser {} for an iteration\n"
             "change of them in per cent at the low and at the high end of a number's range\n{}",
             ms(base.frame), workers, ms(base.epnp), ms(base.eight_point), ms(base.iteration),
             table.str()),
         bands_table(sensitivity),
         list_line("changing nothing by 0.005 % or more:", without_effect) +
             list_line("not certain, but without a range:", sensitivity.unbounded)};
}

std::string sensitivity_csv(const Sensitivity& sensitivity) {
  using S = const Swing&;
  base::CsvTable<Swing> table{
      {"number", [](S s) { return s.parameter.path; }},
      {"confidence", [](S s) { return s.parameter.confidence; }},
      {"unit", [](S s) { return s.parameter.unit; }},
      {"value", [](S s) { return s.parameter.value; }},
      {"low", [](S s) { return fmt::format("{}", s.parameter.range->low); }},
      {"high", [](S s) { return fmt::format("{}", s.parameter.range->high); }}};
  for (const TimeColumn& column : kColumns) {
    const auto of = column.of;
    const std::optional<double> base_ms = sensitivity.base.*of;
    const auto add = [&](const char* name, auto value) {
      table.add(fmt::format("{}_{}", column.key, name),
                [=](S s) { return base::fixed(value(s), 6); });
    };
    add("base_ms", [=](S) { return base_ms; });
    add("low_ms", [=](S s) { return s.low.*of; });
    add("high_ms", [=](S s) { return s.high.*of; });
    add("low_percent", [=](S s) { return percent_change(s.low.*of, base_ms); });
    add("high_percent", [=](S s) { return percent_change(s.high.*of, base_ms); });
  }
  for (const auto& [stage, kcycles] : sensitivity.base.stages) {
    const auto add = [&table, stage = stage, kcycles = kcycles](const char* name,
                                                                MeanTimes Swing::*end) {
      table.add(fmt::format("{}_{}", key_of(stage), name), [=](S s) {
        return base::fixed(percent_change((s.*end).stage(stage), kcycles), 6);
      });
    };
    add("low_percent", &Swing::low);
    add("high_percent", &Swing::high);
  }
  return table.text(sensitivity.swings);
}

}  // namespace leviosim::tools
