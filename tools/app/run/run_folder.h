// The files that a run leaves behind. Same inputs, same bytes, except the member "host" of
// manifest.json.
//
//   run.json         the record (record/record.h): facts, figures, verdicts, cycles by cause
//   manifest.json    what the run was made from, and by whom
//   platform.yaml    the resolved platform, overrides included; loads as a platform file
//   stages.csv       a row per stage: calls, cycles, breakdown on N cores and on one, operations
//   frames.csv       a row per frame, with the cycles of each stage on N cores
//   errors.csv       a row per pose that has a truth: both positions after alignment, and the error
//   memory.csv       a row per peak, and per block alive at it
//   energy.csv       a row per stage, quantity and domain of the chip, with its band
//   cycles.csv       where the cycles of each stage went, as in run.json
//   trajectory.tum   poses of the body, for evo and rpg_trajectory_evaluation
//   work.trace       with --record: all work (traces/work_traces/work_trace.h), for leviosim replay
//   flight.film      with --film: images and features (tools/app/film/film.h), for interactive
//   pages replay.csv       of a replay: how each frame began, in the recording and now
//
// A native run has no platform.yaml, stages.csv, memory.csv, energy.csv and cycles.csv, and no
// timing columns. A platform without energy figures leaves no energy.csv. Programs read run.json;
// pages also the tables.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "tools/app/record/record.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/manifest.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {

inline constexpr const char* kRecordFile = "run.json";
inline constexpr const char* kManifestFile = "manifest.json";
inline constexpr const char* kWorkTraceFile = "work.trace";
inline constexpr const char* kReplayFile = "replay.csv";
inline constexpr const char* kFramesFile = "frames.csv";
inline constexpr const char* kStagesFile = "stages.csv";
inline constexpr const char* kMemoryFile = "memory.csv";
inline constexpr const char* kEnergyFile = "energy.csv";
inline constexpr const char* kErrorsFile = "errors.csv";
inline constexpr const char* kCyclesFile = "cycles.csv";
inline constexpr const char* kTrajectoryFile = "trajectory.tum";

/// Begins the columns of frames.csv with the cycles of a stage: "cycles_epnp_ransac".
inline constexpr const char* kStageColumn = "cycles_";

/// The record of a run that lies in memory.
RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run);

/// What the folder of a run holds.
struct RunFolder {
  RunRecord record;
  Json manifest;
  std::map<std::string, Table> tables = {};  ///< by the names of their files
  /// Name → content of what programs do not read.
  std::map<std::string, std::string> others = {};
  std::shared_ptr<const RunResult> run = {};  ///< of which long tables are made; none if read
};

/// @param name           of the record
/// @param platform_yaml  unused for a native run
RunFolder run_folder(std::string name, std::shared_ptr<const RunResult> run,
                     const Manifest& manifest, const std::string& platform_yaml);

/// Name → content. The folder outlives it.
std::map<std::string, outputs::Content> files_of(const RunFolder& run);

/// Writes into a folder that the caller has claimed. @throws InputError if a file cannot be written
/// @param below  folder in it, "chosen/"
void write_run_folder(outputs::OutputFolder& out, const RunFolder& run,
                      const std::string& below = {});

/// Reads what is as the run wrote it; without the other files.
/// @param with_tables  and the manifest; else the record alone
/// @throws InputError if the folder is not that of a run
RunFolder read_run_folder(const std::filesystem::path& folder, bool with_tables);

}  // namespace leviosim::tools
