// Area of a chip, part by part, as a table for terminals and as CSV.
#pragma once

#include <string>

#include "sim/chip/config.h"
#include "tools/app/table/table.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {

/// Parts with number, size, band and share; then cluster and chip. The chip must have areas.
std::string area_table(const sim::ChipConfig& chip, int width = table_width());

/// The same rows, in um2.
Table area_rows(const sim::ChipConfig& chip);

}  // namespace leviosim::tools
