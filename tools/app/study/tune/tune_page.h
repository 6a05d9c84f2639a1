// A tuning as a page for a browser: curves over the clock, and all runs to explore.
#pragma once

#include <vector>

#include "tools/app/html_report/study_json.h"
#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {

/// The data of the page.
Json tune_page(const TunePlan& plan, const std::vector<TunePoint>& points,
               const std::vector<Choice>& choices);

}  // namespace leviosim::tools
