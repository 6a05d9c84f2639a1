// A point of a study, and the key under which its outcome is kept.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/schema.h"
#include "tools/app/run/run_request.h"
#include "traces/datasets/dataset.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

struct Sequence;

/// A run, native or on a chip, or recorded work that is timed on a chip.
struct Point {
  RunRequest request;
  std::string work;                          ///< what is read: work_of()
  const traces::WorkTrace* trace = nullptr;  ///< replayed if there is one
  const Sequence* sequence = nullptr;        ///< whose truth the run is compared with, if at all
  std::size_t row = 0;  ///< of the study's table; several points of a row are condensed
};

/// All that an outcome depends on, besides the program: work, parameters of the workload, the chip
/// and the camera. The folder does not count, and parameters count as they are, set or not.
/// @returns a line per part
std::string identity_of(const Point& point, const platform::Schema& schema);

/// A digest of everything that an outcome depends on, the simulator included.
/// @param kept      which figures of the point are kept
/// @param identity  identity_of() the point
/// @returns 64 hexadecimal digits
std::string point_key(std::string_view kept, const std::string& identity);

// A recorded or rendered flight as an input of studies.

struct Sequence {
  std::string name;    ///< folders of one name are taken together: texture worlds of one flight
  std::string folder;  ///< ASL
  std::string inputs;  ///< SHA-256 of what is read from it
  std::size_t frames = 0;
  double path_m = 0;           ///< of the truth over these frames
  traces::Trajectory truth{};  ///< T_world_body
  std::string work{};          ///< work_of() the frames
};

/// "DIR" or "NAME=DIR"; without name, the folder's.
struct NamedFolder {
  std::string name;
  std::string folder;
};
/// @throws InputError for names that tables cannot hold
NamedFolder parse_named_folder(const std::string& text);

/// All that is read from a folder as one SHA-256. @throws InputError for files that cannot be read
std::string digest_of(const traces::Dataset& data);

/// What a run over these frames reads, for Point::work. @param digest  digest_of(data)
std::string work_of(const traces::Dataset& data, const std::string& digest);

/// @throws InputError for folders that cannot be read, have no ground truth, or cannot be prepared
///         for one of the sizes
Sequence open_sequence(const NamedFolder& named, const std::optional<traces::FrameRange>& frames,
                       const std::vector<traces::ImageSize>& sizes);

}  // namespace leviosim::tools
