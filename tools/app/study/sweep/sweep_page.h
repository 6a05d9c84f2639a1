// A sweep as a page for a browser: all finished points to explore, and curves where one or two
// parameters vary.
#pragma once

#include "tools/app/html_report/study_json.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {

/// The data of the page, after the store has been published.
Json sweep_page(SweepStore& store);

}  // namespace leviosim::tools
