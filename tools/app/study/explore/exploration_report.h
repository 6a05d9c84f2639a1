// What an exploration found, as text, CSV and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/explore/exploration.h"
#include "tools/app/study/runs_csv.h"

namespace leviosim::tools {

/// Per profile: as it is, the point of least absolute error, and that of least relative error.
std::string best_text(const BatchPlan& plan, const std::vector<ExploredPoint>& explored);
/// What the first profile gains by its best point, in a sentence.
std::string exploration_conclusion(const BatchPlan& plan,
                                   const std::vector<ExploredPoint>& explored);
std::string best_markdown(const BatchPlan& plan, const std::vector<ExploredPoint>& explored);

/// A row per point, profile and sequence, with the value of every dimension; empty where it has no
/// effect on the profile.
std::string points_csv(const std::vector<Dimension>& dimensions,
                       const std::vector<ExploredPoint>& explored);

/// Point and dimensions of every run, for runs_csv(). @param plan,dimensions  outlive the columns
RunColumns point_columns(const BatchPlan& plan, const std::vector<Dimension>& dimensions);

}  // namespace leviosim::tools
