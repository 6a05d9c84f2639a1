// What a run was made from: enough to repeat it, and to see that two runs had the same inputs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/app/report/statistics.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/digest.h"

namespace leviosim::tools {

/// Of manifests, and so of run folders: the one that is written and read. It rises when a file of
/// the folder gets other columns.
inline constexpr int kManifestVersion = 2;

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
