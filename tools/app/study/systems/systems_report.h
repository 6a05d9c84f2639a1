// Published systems beside what leviosim predicts, as a table, as CSV and as a page with power
// over frame rate.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/study_page.h"
#include "tools/app/study/systems/predictions.h"

namespace leviosim::tools {

/// Milli-units in a unit: power is shown in mW, energy in mJ.
inline constexpr double kMilli = 1e3;

/// A row per system and workload, how to read it, and the sources.
std::string systems_table(const std::vector<SystemRow>& rows);

/// How many are modelled, and the one that takes the least energy per frame, in a sentence.
std::string systems_conclusion(const std::vector<SystemRow>& rows);

/// The rows of systems_table() with all digits, as CSV.
Table systems_rows(const std::vector<SystemRow>& rows);

/// The data of a page: power over frame rate, what was published and what is predicted, each as a
/// point. Systems without a rate or a power have none.
StudyPage systems_page(const std::vector<SystemRow>& rows);

}  // namespace leviosim::tools
