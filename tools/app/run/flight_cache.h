// The synthetic flight that `--data synthetic` stands for: made once, then reused.
#pragma once

#include <filesystem>

#include "tools/app/cli/progress_line.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {

/// Of the flight that demos, tests and figures use.
inline constexpr std::uint64_t kFlightSeed = 1;
inline constexpr double kFlightSeconds = 20;

/// ${XDG_CACHE_HOME:-~/.cache}/leviosim/synthetic-SEED-SECONDSs-VERSION. VERSION changes with the
/// sources that make the flight, so an outdated one is never read.
std::filesystem::path flight_folder();

/// The folder of the flight, which is made if it is not there, or not as it was drawn. Several
/// processes may ask at once. @throws InputError if it cannot be written, Interrupted
std::filesystem::path cached_flight(ProgressLine::Style progress);

/// Writes a flight to `folder` with progress. @throws InputError, Interrupted
void write_flight(const std::filesystem::path& folder, const traces::SyntheticOptions& options,
                  ProgressLine::Style progress);

}  // namespace leviosim::tools
