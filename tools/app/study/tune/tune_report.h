// What `leviosim tune` found: tables, and sentences about them.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/study_page.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {

/// A row per point; those that meet the limits first, the lowest clock of them before.
std::string tune_table(const TunePlan& plan, const std::vector<TunePoint>& points);
Table tune_rows(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest clock at each frame rate.
std::string choice_text(const TunePlan& plan, const std::vector<Choice>& choices);

/// That of all, in a sentence.
std::string tune_conclusion(const std::vector<Choice>& choices);

/// What the perturbed runs of the chosen point say of runs that were not tried, as a line; empty
/// for seeds.
std::string claim_text(const TunePlan& plan, const TunePoint& best);

/// What stands below the table: what its figures are, with the protocol of the errors.
std::string tune_notes(const TunePlan& plan);
/// What choice_text() says, as members of a document: `lowest`, an array, and `chosen`.
Json choice_json(const TunePlan& plan, const std::vector<Choice>& choices);
StudyPage tune_page(const TunePlan& plan, const std::vector<TunePoint>& points,
                    const std::vector<Choice>& choices);

}  // namespace leviosim::tools
