#include "tools/app/budget/figures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "platform_models/loader/parameter_units.h"
#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

using platform::Unit;

constexpr std::array kOfAStage{
    FigurePhrase{"cycles", "stages.{}.cycles.parallel.mean", "cycles"},
    FigurePhrase{"cycles on one core", "stages.{}.cycles.single.mean", "cycles"},
    FigurePhrase{"worst cycles", "stages.{}.cycles.parallel.worst", "cycles"},
    FigurePhrase{"time", "stages.{}.time.parallel.mean", "ms"},
    FigurePhrase{"speed-up", "stages.{}.speedup", "1"},
    FigurePhrase{"calls", "stages.{}.calls", "1"},
    FigurePhrase{"operations", "stages.{}.operations", "1"},
    FigurePhrase{"memory peak", "stages.{}.memory.parallel", "byte"},
    FigurePhrase{"energy per call", "energy.{}.call", "uJ"},
};

constexpr std::array kCycleUnits{Unit{"cycles", 1}, Unit{"kcycles", 1e3}, Unit{"Mcycles", 1e6}};
constexpr std::array kCoreCycleUnits{Unit{"core-cycles", 1}};
constexpr std::array kEnergyUnits{Unit{"J", 1}, Unit{"mJ", 1e-3}, Unit{"uJ", 1e-6},
                                  Unit{"nJ", 1e-9}};
constexpr std::array kLengthUnits{Unit{"m", 1}, Unit{"cm", 1e-2}, Unit{"mm", 1e-3}};
constexpr std::array kAngleUnits{Unit{"deg", 1}};
constexpr std::array kAngleRateUnits{Unit{"deg/m", 1}};
constexpr std::array kPercentUnits{Unit{"%", 1}};
constexpr std::array kFrameRateUnits{Unit{"1/s", 1}, Unit{"frames/s", 1}};
constexpr std::array kPixelUnits{Unit{"px", 1}};
constexpr std::array kNumberUnits{Unit{"", 1}, Unit{"%", 1e-2}};  // counts, ratios and shares

/// How limits on a statistic may be written, by its unit.
struct StatisticUnit {
  std::string_view name;
  std::span<const Unit> units;
  double factor;  ///< base units in one of it
  double shown;   ///< of it in what people read
  std::string_view shown_unit;
  int decimals;
};
constexpr std::array kStatisticUnits{
    StatisticUnit{"cycles", kCycleUnits, 1, 1e3, "kcycles", 1},
    StatisticUnit{"core-cycles", kCoreCycleUnits, 1, 1, "core-cycles", 0},
    StatisticUnit{"ns", platform::kTimeUnits, 1e-9, 1e6, "ms", 3},
    StatisticUnit{"ms", platform::kTimeUnits, 1e-3, 1, "ms", 3},
    StatisticUnit{"byte", platform::kSizeUnits, 1, 1e3, "kB", 1},
    StatisticUnit{"mJ", kEnergyUnits, 1e-3, 1, "mJ", 4},
    StatisticUnit{"uJ", kEnergyUnits, 1e-6, 1, "uJ", 2},
    StatisticUnit{"mW", platform::kPowerUnits, 1e-3, 1, "mW", 2},
    StatisticUnit{"Hz", platform::kFrequencyUnits, 1, 1e6, "MHz", 2},
    StatisticUnit{"V", platform::kVoltageUnits, 1, 1, "V", 3},
    StatisticUnit{"m", kLengthUnits, 1, 1, "m", 4},
    StatisticUnit{"deg", kAngleUnits, 1, 1, "deg", 3},
    StatisticUnit{"deg/m", kAngleRateUnits, 1, 1, "deg/m", 4},
    StatisticUnit{"%", kPercentUnits, 1, 1, "%", 3},
    StatisticUnit{"1/s", kFrameRateUnits, 1, 1, "frames/s", 2},
    StatisticUnit{"px", kPixelUnits, 1, 1, "px", 0},
    StatisticUnit{"1", kNumberUnits, 1, 1, "", 4},
};

const StatisticUnit* find_unit(std::string_view name) {
  const auto it = std::find_if(kStatisticUnits.begin(), kStatisticUnits.end(),
                               [&](const StatisticUnit& u) { return u.name == name; });
  return it == kStatisticUnits.end() ? nullptr : &*it;
}

[[noreturn]] void fail(const Limit& limit, const std::string& message) {
  platform::place_of(limit.file, limit.line, "").fail(message);
}

/// Of the unit "map verdict": what it may be.
std::vector<VerdictWord> words_of(std::string_view unit) {
  std::vector<VerdictWord> words;
  for (const VerdictWord& word : verdict_words())
    if (unit == fmt::format("{} verdict", word.about)) words.push_back(word);
  return words;
}

/// The grade of a bound that is a word.
double grade_of(const Limit& limit, std::string_view unit) {
  std::vector<std::string> names;
  for (const VerdictWord& word : words_of(unit)) {
    if (word.word == limit.bound.word) return severity(word.grade);
    names.emplace_back(word.word);
  }
  fail(limit, fmt::format("'{}': expected {} <= one of {}{}", limit.text, limit.figure,
                          fmt::join(names, ", "), base::did_you_mean(limit.bound.word, names)));
}

std::span<const FigurePhrase> phrases_for(const Limit& limit) {
  return limit.stage.empty() ? run_phrases() : stage_phrases();
}

const FigurePhrase* find_phrase(const Limit& limit) {
  const auto phrases = phrases_for(limit);
  const auto it = std::find_if(phrases.begin(), phrases.end(),
                               [&](const FigurePhrase& p) { return p.phrase == limit.figure; });
  return it == phrases.end() ? nullptr : &*it;
}

/// Names of statistics have dots, phrases have none.
bool is_statistic(const std::string& figure) {
  return figure.find('.') != std::string::npos || figure.find('*') != std::string::npos;
}

std::vector<std::string> phrase_names(std::span<const FigurePhrase> phrases) {
  std::vector<std::string> names;
  for (const FigurePhrase& p : phrases) names.emplace_back(p.phrase);
  return names;
}

/// Of the names of statistics.
std::string pattern_of(const Limit& limit, const FigurePhrase* phrase) {
  return phrase != nullptr ? std::string(phrase->statistic) : limit.figure;
}

/// Of a name "stages.KEY.…".
std::string stage_in(const std::string& statistic, const RunRecord& run) {
  for (const StageName& stage : run.stages)
    for (const char* prefix : {"stages.", "energy."})
      if (statistic.rfind(prefix + stage.key + '.', 0) == 0) return stage.name;
  return {};
}

}  // namespace

std::span<const FigurePhrase> run_phrases() {
  static const std::vector<FigurePhrase> all = [] {
    std::vector<FigurePhrase> phrases;
    for (const FigureRow& row : figure_rows())
      if (!row.phrase.empty()) phrases.push_back({row.phrase, row.statistic, row.unit});
    return phrases;
  }();
  return all;
}
std::span<const FigurePhrase> stage_phrases() { return kOfAStage; }

void check_figure(const Limit& limit) {
  if (const FigurePhrase* phrase = find_phrase(limit)) {
    bound_in(limit, phrase->unit);
    return;
  }
  if (limit.stage.empty() && is_statistic(limit.figure)) return;  // the run knows
  const std::vector<std::string> known = phrase_names(phrases_for(limit));
  fail(limit, fmt::format("unknown figure '{}'{}; expected {}{}", limit.figure,
                          base::did_you_mean(limit.figure, known), fmt::join(known, ", "),
                          limit.stage.empty() ? ", or the name of a statistic" : ""));
}

std::vector<FigureOf> find_figures(const Limit& limit, const RunRecord& run) {
  const FigurePhrase* phrase = find_phrase(limit);
  std::vector<FigureOf> found;
  if (phrase != nullptr && !limit.stage.empty()) {
    for (const StageName& stage : run.stages) {
      if (!matches(limit.stage, stage.name) && !matches(limit.stage, stage.key)) continue;
      const std::string name = fmt::format(fmt::runtime(phrase->statistic), stage.key);
      if (const Statistic* statistic = run.find(name)) found.push_back({statistic, stage.name});
    }
    return found;
  }
  const std::string pattern = pattern_of(limit, phrase);
  for (const Statistic& s : run.statistics)
    if (matches(pattern, s.name)) found.push_back({&s, stage_in(s.name, run)});
  return found;
}

std::vector<FigureOf> figures_of(const Limit& limit, const RunRecord& run) {
  std::vector<FigureOf> found = find_figures(limit, run);
  if (!found.empty()) return found;
  std::vector<std::string> names;
  const FigurePhrase* phrase = find_phrase(limit);
  if (phrase != nullptr && !limit.stage.empty()) {
    for (const StageName& stage : run.stages) names.push_back(stage.name);
    fail(limit, fmt::format("no stage '{}' with '{}' in {}; its stages are {}{}", limit.stage,
                            limit.figure, run.name, fmt::join(names, ", "),
                            base::did_you_mean(limit.stage, names)));
  }
  for (const Statistic& s : run.statistics) names.push_back(s.name);
  const std::string pattern = pattern_of(limit, phrase);
  fail(limit, fmt::format("{} has no statistic '{}'{}", run.name, pattern,
                          base::did_you_mean(pattern, names)));
}

bool is_percent_of_baseline(const Bound& bound) { return bound.relative && bound.unit == "%"; }

double bound_in(const Limit& limit, std::string_view statistic_unit) {
  const Bound& bound = limit.bound;
  if (!bound.word.empty() && words_of(statistic_unit).empty())
    fail(limit, fmt::format("'{}': expected a number", limit.text));
  if (is_percent_of_baseline(bound)) return bound.number;
  if (!words_of(statistic_unit).empty()) return grade_of(limit, statistic_unit);
  const StatisticUnit* known = find_unit(statistic_unit);
  if (known == nullptr)
    fail(limit, fmt::format("'{}': a statistic in {} can only be compared with a baseline, in %",
                            limit.text, statistic_unit));
  for (const Unit& unit : known->units)
    if (unit.name == bound.unit) return bound.number * unit.factor / known->factor;
  if (bound.unit == "%")
    fail(limit,
         fmt::format("'{}': per cent of what? A sign is missing: {} {}{:g} % is of the baseline",
                     limit.text, bound.at_most ? "<=" : ">=", bound.at_most ? '+' : '-',
                     bound.number));
  std::vector<std::string> names;
  for (const Unit& unit : known->units) names.emplace_back(unit.name.empty() ? "none" : unit.name);
  fail(limit, fmt::format(
                  "'{}': {}; expected {}{}", limit.text,
                  bound.unit.empty() ? "has no unit" : fmt::format("unknown unit '{}'", bound.unit),
                  fmt::join(names, ", "), base::did_you_mean(bound.unit, names)));
}

ShownUnit shown_unit(std::string_view statistic_unit) {
  const StatisticUnit* known = find_unit(statistic_unit);
  return known == nullptr ? ShownUnit{statistic_unit, 1}
                          : ShownUnit{known->shown_unit, known->shown};
}

std::string figure_text(double value, std::string_view statistic_unit) {
  for (const VerdictWord& word : words_of(statistic_unit))
    if (severity(word.grade) == value) return std::string(word.word);
  const StatisticUnit* known = find_unit(statistic_unit);
  if (known == nullptr) return fmt::format("{} {}", value, statistic_unit);
  const std::string number = fmt::format("{:.{}f}", value / known->shown, known->decimals);
  return known->shown_unit.empty() ? number : fmt::format("{} {}", number, known->shown_unit);
}

std::string figure_text(double value, std::string_view statistic_unit, const Bound& bound) {
  if (statistic_unit == "1" && bound.unit == "%" && !bound.relative)
    return fmt::format("{:.2f} %", 100 * value);
  return figure_text(value, statistic_unit);
}

}  // namespace leviosim::tools
