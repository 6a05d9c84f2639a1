// What is known of a run when it is compared or checked: facts about its inputs, its statistics,
// and where its cycles went. It is read from a run folder, put together after a run or a replay, or
// read from a baseline (budget/baseline.h).
//
// Besides the statistics of stats.json there are those that follow from them and from all frames
// (result/run_figures.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/app/comparison/cycle_parts.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {

struct RunFacts {
  bool measured = false;  ///< elsewhere (measured.h): nothing is known but profile and platform
  std::string program;    ///< "0.1.0 ea4229934d2b"
  std::string profile;
  std::vector<std::string> workload;  ///< parameters that were set
  std::uint32_t seed = 1;
  std::string platform;  ///< as requested; empty for a native run
  std::vector<std::string> overrides;
  int cores = 0;
  std::string camera;  ///< of a closed loop, "10 frames/s, drop"; else empty
  int image_width = 0;
  int image_height = 0;
  std::int64_t first_frame = 0;
  std::int64_t frames = 0;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< of the data: name → SHA-256

  friend bool operator==(const RunFacts&, const RunFacts&) = default;
};

struct RunRecord : RunFigures {
  std::string name;  ///< in the words of the user
  RunFacts facts;
  std::vector<StageParts> cycles;  ///< empty if the run folder has no cycles.csv

  /// Null if there is no such stage.
  const StageParts* stage_parts(std::string_view stage) const;
};

/// The record of a run that is at hand.
RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run,
                      std::vector<StageParts> cycles);

/// The files of a run folder that records and reports are made of; older folders lack some.
/// @throws InputError if the folder is not that of a run
RunFiles read_run_files(const std::filesystem::path& folder);

/// @param where  begins messages, and is the name of the record
/// @throws InputError if a file does not hold what leviosim writes
RunRecord record_of_files(const std::string& where, const RunFiles& files);

/// Both.
RunRecord read_run_folder(const std::filesystem::path& folder);

/// The document in a text. @throws InputError that begins with `where`
Json parse_json(const std::string& where, const std::string& text);

/// The facts in JSON and back: for baselines. @throws InputError
Json facts_json(const RunFacts& facts);
RunFacts facts_of_json(const std::string& where, const Json& json);

}  // namespace leviosim::tools
