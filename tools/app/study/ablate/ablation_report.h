// The rows of an ablation as text, Markdown and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/ablate/ablation.h"

namespace leviosim::tools {

/// Beside the paper's values where it has such, with the protocol below.
std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows);
/// The row with the least absolute error, in a sentence.
std::string ablation_conclusion(const std::vector<AblationRow>& rows);
std::string ablation_markdown(const BatchPlan& plan, const std::vector<AblationRow>& rows);
Json ablation_json(const BatchPlan& plan, const std::vector<AblationRow>& rows);

}  // namespace leviosim::tools
