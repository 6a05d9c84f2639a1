// The inputs of a run: enough to repeat it, and to see whether two runs had the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/app/result/run_result.h"
#include "tools/app/table/json.h"
#include "traces/datasets/dataset.h"

namespace leviosim::tools {

/// SHA-256 of an input.
struct InputDigest {
  std::string name;  ///< relative to the data folder
  std::int64_t bytes = 0;
  std::string sha256;
};

/// @throws InputError if the file cannot be read
InputDigest digest_of_file(const std::filesystem::path& file);

/// The text files of the streams that a run reads, and its frames as one: the concatenation of
/// their image files. @throws InputError for files that cannot be read
std::vector<InputDigest> digest_inputs(const traces::Dataset& data);

struct Manifest {
  std::vector<std::string> command_line;  ///< words as typed
  std::uint32_t seed = 1;                 ///< of the workload
  std::string platform;                   ///< as requested; empty for a native run
  std::vector<std::string> overrides;     ///< of platform parameters
  std::vector<std::string> workload;      ///< its parameters that were set, "workload.window=6"
  std::string data;                       ///< folder that was read, or "synthetic"
  std::size_t first_frame = 0;            ///< index in the folder
  std::vector<InputDigest> inputs;
  Json recording;  ///< of a replay: what its trace says about the run that was recorded
};

/// The content of manifest.json. Its member "host" is the only part of a run folder that differs
/// between two runs of the same program on the same inputs.
Json manifest_json(const Manifest& manifest, const RunResult& run);

}  // namespace leviosim::tools
