// What an interactive page plays besides the work: facts of the frames, the path beside the truth
// where there is one, and the film.
#pragma once

#include <filesystem>
#include <string>

#include "sim/base/units.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

struct FlightData {
  Json flight;       ///< {"facts": columns of frames.csv, "path": columns, "words"}
  std::string film;  ///< [{"image", "features": {state: bytes}, "points": [x, y, …]}], or empty
};

/// @param run     folder of a run
/// @param frames  that its work has
/// @throws InputError as the readers of its files, and for another number of frames
FlightData flight_data(const std::filesystem::path& run, int frames, Bytes memory);

}  // namespace leviosim::tools
