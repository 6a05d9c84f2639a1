// What is known of a run when it is compared or checked: facts about its inputs, its statistics,
// and where its cycles went. It is read from a run folder, put together after a run or a replay, or
// read from a baseline (budget/baseline.h).
//
// Besides the statistics of stats.json there are those of all frames together (kFrameStatistics),
// which need every frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/app/comparison/cycle_parts.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/run/manifest.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {

struct RunFacts {
  std::string program;  ///< "0.1.0 ea4229934d2b"
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

struct Statistic {
  std::string name;
  std::string unit;
  std::string description;
  std::optional<double> value;  ///< absent where the run has none
};

/// A stage, by its name for people and as statistics name it.
struct StageName {
  std::string name;  ///< "EPnP RANSAC"; the key where cycles.csv is missing
  std::string key;   ///< "epnp_ransac"
  bool on_controller = false;
};

struct RunRecord {
  std::string name;  ///< in the words of the user
  RunFacts facts;
  std::vector<StageName> stages;      ///< in the order of the run
  std::vector<Statistic> statistics;  ///< that are numbers
  std::vector<StageParts> cycles;     ///< empty if the run folder has no cycles.csv

  /// Null if there is none of that name.
  const Statistic* find(std::string_view statistic) const;
  /// Absent also if there is no such statistic.
  std::optional<double> value(std::string_view statistic) const;
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

/// A record of texts, as a run folder has them. @param where  begins messages
/// @param frames_csv  with all frames
RunRecord record_of(const std::string& where, const Json& manifest, const Json& statistics,
                    const std::string& frames_csv, std::vector<StageParts> cycles);

/// The document in a text. @throws InputError that begins with `where`
Json parse_json(const std::string& where, const std::string& text);

/// The facts in JSON and back: for baselines. @throws InputError
Json facts_json(const RunFacts& facts);
RunFacts facts_of_json(const std::string& where, const Json& json);

}  // namespace leviosim::tools
