// What an ablation says: its rows as a table, whose columns are described here and nowhere else,
// the sentences about it, and the paper's figures beside it.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/study_page.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// Beside the paper's values where it has such. @param ablation  outlives the table
Table ablation_table(const Ablation& ablation, const std::vector<AblationRow>& rows);

/// Of each profile, as it is, and those of least absolute and of least relative error; all rows
/// where nothing is varied.
std::vector<AblationRow> notable_rows(const Ablation& ablation,
                                      const std::vector<AblationRow>& rows);

/// What the figures are, with the protocol of each sequence; a line each.
std::string ablation_notes(const Ablation& ablation, const std::vector<AblationRow>& rows,
                           const std::string& bullet);

/// The row with the least absolute error, and what it gains, in a sentence.
std::string ablation_conclusion(const Ablation& ablation, const std::vector<AblationRow>& rows);

/// Absolute errors by sequence: those of the ablation, what the paper says of LEVIO, and others'.
/// Empty if nothing was published of the ablation's sequences.
std::string accuracy_comparison(const Ablation& ablation, const std::vector<AblationRow>& rows,
                                const std::vector<PublishedAccuracy>& published);

/// The absolute over the relative error of every row, as the paper's figure has it.
StudyPage ablation_page(const Ablation& ablation, const std::vector<AblationRow>& rows);

}  // namespace leviosim::tools
