// What `leviosim sweep` prints when it is done.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/page_json.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// How many points are done, which failed and which are open, and the Pareto front.
std::string sweep_report(SweepStore& store);
/// In a sentence: whether points cannot run, else how many no other beats.
std::string sweep_conclusion(SweepStore& store);
/// Command lines that say more about a sweep in that folder: what differs between its first point
/// and the first of the front.
std::vector<std::string> after_sweep(SweepStore& store, const std::string& folder);
/// The same for a page: a box, and the front as a table of titles and rows.
StudyBox sweep_box(SweepStore& store);
std::vector<std::vector<std::string>> sweep_front(SweepStore& store);

// The points of a sweep that no other is better than in every respect.

/// Whether `a` is at least as good as `b` in every objective and better in one. Less is better, and
/// what is missing is worse than any number.
bool dominates(const SweepOutcome& a, const SweepOutcome& b);

/// The outcomes that no other dominates, those that failed left out; by latency, then number.
std::vector<SweepOutcome> pareto_front(const std::vector<SweepOutcome>& outcomes);

// A sweep as a page for a browser: all finished points to explore, and curves where one or two
// parameters vary.

/// The data of the page, after the store has been published.
Json sweep_page(SweepStore& store);

}  // namespace leviosim::tools
