// The rows of an ablation as text, Markdown and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/batch_plan.h"

namespace leviosim::tools {

/// Beside the paper's values where it has such, with the protocol below.
std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows);
Json ablation_json(const BatchPlan& plan, const std::vector<AblationRow>& rows);

/// Absolute errors by sequence: those of the ablation, what the paper says of LEVIO, and others'.
/// Empty if nothing was published of the ablation's sequences.
std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PublishedAccuracy>& published);

/// `leviosim ablate` (tools/commands/commands.h).
Command add_ablate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
