// Frames and positions as the files of a run folder have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/app/result/run_figures.h"

namespace leviosim::tools {

/// The rows of frames.csv; those of a native run have no times.
/// @throws InputError for a table that cannot be read
std::vector<RecordedFrame> read_frames(const std::filesystem::path& file, const std::string& csv);

/// The rows of errors.csv. @throws InputError for a table that cannot be read
std::vector<PositionPair> read_positions(const std::filesystem::path& file, const std::string& csv);

}  // namespace leviosim::tools
