#include "tools/app/study/sensitivity/sensitivity_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

constexpr auto kLeft = TextTable::Align::Left;
constexpr double kShown = 0.005;  ///< per cent; below, 0.00 would be printed
constexpr int kWidth = 100;

struct OutcomeColumn {
  const char* title;
  const char* key;
  std::optional<double> Outcome::*of;
};
constexpr std::array kColumns{
    OutcomeColumn{"frame", "frame", &Outcome::frame},
    OutcomeColumn{"EPnP", "epnp", &Outcome::epnp},
    OutcomeColumn{"8-point", "eight_point", &Outcome::eight_point},
    OutcomeColumn{"optimiser", "iteration", &Outcome::iteration},
};

std::string ms(std::optional<double> value) {
  return value ? fmt::format("{:.3f} ms", *value) : "–";
}

/// "-1.2 … +3.4", what the ends of the range do.
std::string change_text(const Swing& swing, const Outcome& base,
                        std::optional<double> Outcome::*of) {
  const auto low = percent_change(swing.low.*of, base.*of);
  const auto high = percent_change(swing.high.*of, base.*of);
  if (!low || !high) return "–";
  return fmt::format("{:+.2f} … {:+.2f}", *low, *high);
}

std::string number(std::optional<double> value) {
  return value ? fmt::format("{:.6f}", *value) : std::string();
}

std::string list_line(const std::string& title, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return title + "\n  " + wrap(names, ", ", 2, kWidth) + '\n';
}

}  // namespace

std::string sensitivity_table(const Sensitivity& sensitivity, int workers) {
  std::vector<TextTable::Column> columns{
      {"number", kLeft}, {"confidence", kLeft}, {"value"}, {"range", kLeft}};
  for (const OutcomeColumn& column : kColumns) columns.push_back({column.title});
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
    for (const OutcomeColumn& column : kColumns)
      cells.push_back(change_text(swing, sensitivity.base, column.of));
    table.add(std::move(cells));
  }
  const Outcome& base = sensitivity.base;
  return fmt::format(
             "mean times with all numbers as they are: front end {} on {} cores (EPnP {}, 8-point "
             "{}), optimiser {} for an iteration\n"
             "change of them in per cent at the low and at the high end of a number's range\n{}",
             ms(base.frame), workers, ms(base.epnp), ms(base.eight_point), ms(base.iteration),
             table.str()) +
         list_line("changing nothing by 0.005 % or more:", without_effect) +
         list_line("not certain, but without a range:", sensitivity.unbounded);
}

std::string sensitivity_csv(const Sensitivity& sensitivity) {
  std::string text = "number,confidence,unit,value,low,high";
  for (const OutcomeColumn& column : kColumns)
    text += fmt::format(",{0}_base_ms,{0}_low_ms,{0}_high_ms,{0}_low_percent,{0}_high_percent",
                        column.key);
  text += '\n';
  for (const Swing& swing : sensitivity.swings) {
    const platform::Parameter& p = swing.parameter;
    text += fmt::format("{},{},{},{},{},{}", p.path, p.confidence, p.unit, p.value, p.range->low,
                        p.range->high);
    for (const OutcomeColumn& column : kColumns) {
      const auto base = sensitivity.base.*column.of;
      text += fmt::format(",{},{},{},{},{}", number(base), number(swing.low.*column.of),
                          number(swing.high.*column.of),
                          number(percent_change(swing.low.*column.of, base)),
                          number(percent_change(swing.high.*column.of, base)));
    }
    text += '\n';
  }
  return text;
}

}  // namespace leviosim::tools
