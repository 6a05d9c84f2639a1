// What if, for people and programs: text of 80 columns, CSV, and a page with bars.
#pragma once

#include <string>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/html_report/page.h"
#include "tools/app/study/whatif/whatif.h"

namespace leviosim::tools {

/// A bar a variant: the time of a mean frame, and its energy.
std::string whatif_bars(const std::vector<VariantResult>& results);

Table whatif_rows(const std::vector<VariantResult>& results);

/// `leviosim whatif` (tools/commands/commands.h).
Command add_whatif_command(CLI::App& app, const Arguments& words);

}  // namespace leviosim::tools
