// What an interactive page plays besides the work: facts of the frames, the path beside the truth
// where there is one, and the film.
#pragma once

#include <string>

#include "tools/app/interactive/interactive_page.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

/// {"facts": columns of frames.csv, "path": columns, or null without poses, "words"}
/// @throws InputError for tables that lack columns, or are of other frames than the work
Json flight_json(const RecordedRun& run);

/// [{"image", "features": {state: bytes}, "points": [x, y, …]}, …] in JSON; empty without a film.
/// @throws InputError as flight_json()
std::string film_text(const RecordedRun& run);

}  // namespace leviosim::tools
