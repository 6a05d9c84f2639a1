// What `leviosim sweep` prints when it is done.
#pragma once

#include <string>

#include "tools/app/html_report/study_json.h"
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

}  // namespace leviosim::tools
