// A history for people: a table of its newest runs, and a page with charts over commits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/app/budget/budget.h"
#include "tools/app/cli/printout.h"
#include "tools/app/history/history.h"

namespace leviosim::tools {

/// "2026-11-26", in UTC.
std::string date_text(std::int64_t time_s);

/// A row a run with what changed, the newest last, and what became of the limits of a budget.
/// @param runs    comparable ones, the oldest first
/// @param budget  whose steps and drifts are named; may be null
/// @param next    command lines to try
Printout history_printout(const std::vector<PastRun>& runs, const Budget* budget,
                          std::vector<std::string> next);

/// The same as JSON: a list of runs with their figures.
std::string history_document(const std::vector<PastRun>& runs);

/// The figures of a run as other trackers read them: "github-action-benchmark" (smaller is better),
/// or "bencher" (Bencher Metric Format). @throws InputError for another format
std::string exported(const PastRun& run, const std::string& format);

/// Charts of the figures over runs, with the limits of the budget, and two runs beside each other.
/// Of long histories the runs that changed something, and the newest.
Json history_page(const std::string& title, const std::vector<PastRun>& runs, const Budget* budget);

}  // namespace leviosim::tools
