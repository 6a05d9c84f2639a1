// What `leviosim tune` found, as text, CSV and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/page.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tuning.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// A row per point.
std::string tune_table(const TunePlan& plan, const std::vector<TunePoint>& points);
Table tune_rows(const TunePlan& plan, const std::vector<TunePoint>& points);

/// The lowest clock at each frame rate.
std::string choice_text(const TunePlan& plan, const std::vector<Choice>& choices);

/// That of all, in a sentence.
std::string tune_conclusion(const std::vector<Choice>& choices);

/// `leviosim tune` (tools/commands/commands.h).
Command add_tune_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
