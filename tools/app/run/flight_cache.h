// Flights that are drawn once, then reused: the synthetic flight that `--data synthetic` stands
// for, and those that a study has rendered.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tools/app/cli/progress_line.h"
#include "traces/synthesis/rendered_flight.h"
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

/// The folder of this name in the cache. `write` makes the flight if it is not there, or not as it
/// was drawn, and then has to repair what is there. Several processes may ask at once.
/// @throws what write() throws, InputError if it cannot be written, Interrupted
std::filesystem::path cached_flight(
    const std::string& name, const std::function<void(const std::filesystem::path& folder)>& write);

/// Writes a flight to `folder` with progress. @throws InputError, Interrupted
void write_flight(const std::filesystem::path& folder, const traces::SyntheticOptions& options,
                  ProgressLine::Style progress);

/// Writes a flight along a recorded motion to `folder`, with progress that begins with `title`.
/// @throws InputError, Interrupted
void render_flight(const std::filesystem::path& motion, const std::filesystem::path& folder,
                   const traces::RenderedFlightOptions& options, const std::string& title,
                   ProgressLine::Style progress);

}  // namespace leviosim::tools
