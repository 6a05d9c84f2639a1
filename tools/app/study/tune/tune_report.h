// What `leviosim tune` found, as text, CSV and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/page_json.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/study/tune/tuning.h"

namespace leviosim::tools {

/// A row per point.
std::string tune_table(const TunePlan& plan, const std::vector<TunePoint>& points);
/// What stands below the table: what its figures are, with the protocol of the errors.
std::string tune_notes(const TunePlan& plan);
std::string tune_csv(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest clock at each frame rate.
std::string choice_text(const TunePlan& plan, const std::vector<Choice>& choices);

/// That of all, in a sentence.
std::string tune_conclusion(const std::vector<Choice>& choices);

/// The same as boxes of a page, one for each frame rate.
std::vector<StudyBox> choice_boxes(const TunePlan& plan, const std::vector<Choice>& choices);

/// What choice_text() says, as members of a document: `lowest`, an array, and `chosen`.
Json choice_json(const TunePlan& plan, const std::vector<Choice>& choices);

/// The content of manifest.json. Nothing in it depends on the host or on cache hits.
Json tune_manifest(const TunePlan& plan, const std::vector<Choice>& choices,
                   const Words& command_line);

// A tuning as a page for a browser: curves over the clock, and all runs to explore.

/// The data of the page.
Json tune_page(const TunePlan& plan, const std::vector<TunePoint>& points,
               const std::vector<Choice>& choices);

}  // namespace leviosim::tools
