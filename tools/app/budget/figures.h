// The figures that a limit may name: phrases for those of most budgets, and all statistics of a run
// by their names, with the units of limits.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// A phrase for a statistic.
struct FigurePhrase {
  std::string_view phrase;
  std::string_view statistic;  ///< with {} for the key of a stage
  std::string_view unit;       ///< of the statistic
};
/// Of a run, and of a stage.
std::span<const FigurePhrase> run_phrases();
std::span<const FigurePhrase> stage_phrases();

/// Checks a limit before there is a run: the unit of a phrase, and names close to a phrase.
/// @throws InputError at the limit's line
void check_figure(const Limit& limit);

/// A statistic that a limit is about.
struct FigureOf {
  const Statistic* statistic;
  std::string stage;  ///< its name, if it is that of a stage
};
/// All that the limit's figure and stage match; may be none.
std::vector<FigureOf> find_figures(const Limit& limit, const RunRecord& run);
/// The same. @throws InputError at the limit's line if there is
/// none, with the nearest name
std::vector<FigureOf> figures_of(const Limit& limit, const RunRecord& run);

/// The number of a bound in the unit of a statistic; of a relative bound in per cent, the per cent.
/// @throws InputError at the limit's line for a missing or another unit
double bound_in(const Limit& limit, std::string_view statistic_unit);

/// Whether a bound is a change in per cent of the baseline.
bool is_percent_of_baseline(const Bound& bound);

/// The unit in which people see a statistic, and its size in the statistic's unit.
struct ShownUnit {
  std::string_view name;
  double size = 1;
};
ShownUnit shown_unit(std::string_view statistic_unit);

/// "9 411.0 kcycles", "43.3 ms": a value of a statistic for people.
std::string figure_text(double value, std::string_view statistic_unit);
/// The same beside a limit: a share that is limited in % is shown in %.
std::string figure_text(double value, std::string_view statistic_unit, const Bound& bound);

}  // namespace leviosim::tools
