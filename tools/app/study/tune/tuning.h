// Accuracy and power of closed loops over clock and frame rate, and the lowest clock that is
// enough.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/html_report/page.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/point.h"
#include "tools/app/study/spread.h"
#include "tools/app/study/tune/tune_plan.h"

namespace leviosim::tools {

/// A clock at a frame rate.
struct TunePoint {
  double fps = 0;
  ClockSetting setting;
  std::vector<RunOutcome> outcomes;  ///< by variation; of those for screening, or of all

  /// Median over the variations of a figure of their loops.
  double median(const std::function<double(const LoopOutcome&)>& of) const;
  /// The same of a figure that chips without energies lack.
  std::optional<Banded> median(std::optional<Banded> LoopOutcome::*of) const;
  /// Dropped or late frames over all, and dropped ones.
  double miss_rate() const;
  double drop_rate() const;
  /// Of the absolute errors; one above the length of the path counts as diverged.
  Spread ate() const;
  /// Runs that err more than that, or diverged.
  std::size_t failures(double ate_m) const;
  /// Least share of frames with a pose that was compared.
  double completion() const;
};

/// The closed loop of a point.
RunRequest request_of(const TunePlan& plan, double fps, const ClockSetting& setting,
                      const Variation& variation);

/// By frame rate, clock, then variation, those for screening; the sequence of the plan must outlive
/// them.
std::vector<Point> tune_runs(const TunePlan& plan);

/// @param runs  tune_runs()
std::vector<TunePoint> tune_points(const TunePlan& plan, const std::vector<Point>& runs,
                                   const std::vector<RunOutcome>& outcomes);

/// Whether it misses no more frames than the plan allows, and 95 % of its runs err no more.
bool is_enough(const TunePoint& point, const TunePlan& plan);

/// What the plan's limits come to at a frame rate.
struct Choice {
  double fps = 0;
  /// The lowest clock that is enough, as all higher ones are; none if the highest is not.
  const TunePoint* lowest = nullptr;
  /// Lower clocks that are enough, but below one that is not: no clocks to build on.
  std::vector<const TunePoint*> lucky;
  const TunePoint* highest_failing = nullptr;
};
/// By frame rate. @param points  outlive the choices
std::vector<Choice> choices(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest of these clocks; of equal clocks, that of the higher frame rate. nullptr if none is
/// enough.
const TunePoint* chosen(const std::vector<Choice>& choices);

using RunTunePoints = std::function<std::vector<RunOutcome>(const std::vector<Point>&)>;
/// Adds the other variations to the lowest clocks that are enough, and, where one then is not, to
/// the next higher ones. @param run  what runs them
void confirm(const TunePlan& plan, std::vector<TunePoint>& points, const RunTunePoints& run);

/// Of which share of all runs it can be said, with 95 % confidence, that they do not fail, where so
/// many were drawn: nearly 1 - 3 / runs, if none of them failed.
double share_held(std::size_t runs, std::size_t failures);

/// A line for a shell that runs a point by itself: unperturbed, or with each seed into a folder of
/// its own: chosen, or chosen-1, chosen-2, … if there are several.
std::string run_command_text(const TunePlan& plan, const TunePoint& point);
/// The options of that command, with the first variation.
RunOptions run_options_of(const TunePlan& plan, const TunePoint& point);

}  // namespace leviosim::tools
