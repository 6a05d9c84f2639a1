// A recorded run as a page that computes (README.md): `leviosim report RUN --interactive`.
#pragma once

#include <string>
#include <vector>

#include "sim/base/units.h"
#include "tools/app/film/film.h"
#include "tools/app/run/run_folder.h"
#include "traces/trajectories/trajectory.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

/// What a page holds; all of it outlives the call.
struct RecordedRun {
  std::string name;  ///< of its folder, as commands have it
  const traces::WorkTrace& trace;
  const RunFolder& folder;
  const traces::Trajectory& poses;     ///< may be none
  const std::vector<FilmFrame>& film;  ///< empty if there is none
};

bool has_engine();
/// @throws InputError if this program was built without the engine, saying how to build it
void expect_engine();

/// The page as one file. @throws InputError if parts of the run are not of each other
std::string interactive_page(const RecordedRun& run);
/// @param run  folder of a run with --record
/// @throws InputError if it holds no work trace, and as the readers of its files
std::string interactive_page(const std::string& run, Bytes memory);

}  // namespace leviosim::tools
