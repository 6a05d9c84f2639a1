// Recorded flights of all formats that are read, behind one function. A format is a row of a table
// and a file with its reader; which one a folder has is told by the files in it.
#pragma once

#include <filesystem>
#include <span>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

struct RecordingFormat {
  const char* name;   ///< "TUM RGB-D"
  const char* files;  ///< by which it is known: "rgb.txt"
  bool (*is)(const std::filesystem::path& folder);
  /// All that the folder holds, before opened(). Throws InputError (file, line, column or key).
  Dataset (*read)(const std::filesystem::path& folder);
};

/// In the order in which a folder is compared with them.
std::span<const RecordingFormat> recording_formats();

/// The format of a folder. Throws InputError, which says what was looked for, if it has none.
const RecordingFormat& format_of(const std::filesystem::path& folder);

/// Reads the recording in a folder. Throws InputError for anything missing, broken, out of order,
/// or not covered by the IMU, where there is one. Pictures are read later.
Dataset open_recording(const std::filesystem::path& folder, const OpenOptions& options = {});

}  // namespace leviosim::traces
