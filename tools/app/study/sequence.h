// A recorded or rendered flight as an input of studies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/image_file.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {

struct Sequence {
  std::string name;    ///< folders of one name are taken together: texture worlds of one flight
  std::string folder;  ///< ASL
  std::string inputs;  ///< SHA-256 of what is read from it
  std::size_t frames = 0;
  double path_m = 0;           ///< of the truth over these frames
  traces::Trajectory truth{};  ///< T_world_body
  std::string work{};          ///< work_of() the frames
};

/// The last part of a path, with or without a slash at its end.
std::string folder_name(const std::string& folder);

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
