// What is known of a run when it is compared or checked: facts about its inputs, its statistics,
// and where its cycles went. It is read from a run folder, put together after a run or a replay, or
// read from a baseline (budget/gate.h).
//
// Besides the statistics of stats.json there are those that follow from them and from all frames
// (result/run_figures.h).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/app/report/statistic_list.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/result/run_result.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_request.h"
#include "traces/work_traces/work_trace.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

// Where the cycles of each stage went on N cores, as rows: by fork, by mechanism and by kind of
// operation. The file cycles.csv of a run folder holds them. They are the account of the run
// (sim/chip/account.h), in core-cycles over the cores of the team, so that the parts of a stage add
// up to its cycles.
//
// Left out: named functions within a fork. Work is counted between two synchronisation points, over
// all functions that run there (README.md).

inline constexpr const char* kCyclesFile = "cycles.csv";
/// The cycles of a frame that belong to no stage: the controller calls the cluster and hears back.
inline constexpr const char* kOffloadStage = "offload";
/// In the place of a mechanism: small parts together, as a baseline has them.
inline constexpr std::string_view kOtherParts = "other";

/// What a mechanism is, in words. Empty if there is none of that key.
std::string_view describe_mechanism(std::string_view key);

struct CyclePart {
  std::string where;      ///< name of a fork, sim::kSerialFork, or empty: outside of forks
  std::string mechanism;  ///< a key of sim::kMechanisms, or kOtherParts
  std::string operation;  ///< kind of operation or kernel; empty if it is not by operation
  double cycles = 0;      ///< of the stage, over all calls
  double count = 0;       ///< operations, bytes of code, items of kernels; 0: nothing to count
};

struct StageParts {
  std::string stage;
  bool on_controller = false;
  double cycles = 0;  ///< on N cores, over all calls
  std::vector<CyclePart> parts;
};

/// The stages that ran, in the order of the run, and last what is no stage's.
std::vector<StageParts> cycle_parts(const RunResult& run);

/// The same with parts below a share of the stage's cycles made one, the mechanism "other".
StageParts folded(const StageParts& stage, double least_share);
/// The same with all parts made one that another stage does not have.
StageParts folded_like(const StageParts& stage, const StageParts& other);

/// A row per part: stage,runs_on,where,mechanism,operation,cycles,count.
std::string cycles_csv(const std::vector<StageParts>& stages);

/// The inverse. @throws InputError naming file and line
std::vector<StageParts> parse_cycles(const std::filesystem::path& file, std::string text);

struct RunFacts {
  bool measured = false;  ///< elsewhere (see below): nothing is known but profile and platform
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

/// The files of a run folder that records and reports are made of; native runs lack some.
/// @throws InputError if the folder is not that of a run
RunFiles read_run_files(const std::filesystem::path& folder);

/// @param where  begins messages, and is the name of the record
/// @throws InputError if a file does not hold what leviosim writes
RunRecord record_of_files(const std::string& where, const RunFiles& files);

/// Both.
RunRecord read_run_folder(const std::filesystem::path& folder);

/// The facts in JSON and back: for baselines. @throws InputError
Json facts_json(const RunFacts& facts);
RunFacts facts_of_json(const std::string& where, const Json& json);

// Cycles that were measured elsewhere, by the counters of a board or by another simulator, as a
// record that budgets, histories and comparisons take in the place of a run:
//
//   # profile: levio          both lines may be missing; other comments are left alone
//   # platform: gap9
//   stage,cycles,calls        calls may be missing
//   8-point RANSAC,9818116,260
//   frame,15650300
//
// A row is a call, or so many with their mean. Stages have the names or the keys of leviosim; frame
// is the front end as a whole. Left out: times, memory, energy, and where the cycles went.

/// Whether a name is that of a CSV file.
bool is_measured(const std::string& name);

/// @throws InputError naming file, line and column
RunRecord read_measured(const std::string& file);

/// Gives stages of a measurement the names that a run has for their keys; leaves runs as they are.
void name_stages_like(RunRecord& measured, const RunRecord& run);

// The runs that a command line names: folders of runs, or recorded work that is replayed on a chip.

/// The chip on which traces are replayed, and what a trace may take of memory.
struct RecordOptions : RunOptions {
  std::string memory;

  bool names_chip() const { return !platform.empty() || !overrides.empty() || !cores.empty(); }
};

/// Declares --platform, -p, --cores, --max-memory and --quiet.
void add_record_options(CLI::App& command, RecordOptions& options);

/// The trace that a file is, or that a folder holds; else empty.
std::string trace_of(const std::string& name);

/// Of a folder what lies in it, unless the options name a chip; then, and of a trace, what a replay
/// yields, on the chip of the recording if none is named. Of a CSV file what was measured.
/// @param files  gets what a run folder holds, or would; may be null
/// @throws InputError for what is neither, and as replay()
RunRecord read_record(const std::string& name, const RecordOptions& options,
                      RunFiles* files = nullptr);

/// Runs or replays a request, and tells how far it is.
using Compute = std::function<RunResult(const RunRequest&, const ProgressCallback&)>;

/// The record of what `compute` yields, whose cycles are watched meanwhile.
/// @throws InputError as it does, Interrupted
RunRecord computed_record(const std::string& name, RunRequest request, const Manifest& manifest,
                          const Compute& compute, bool quiet, RunFiles* files = nullptr);

/// What a manifest of a replay says of the recorded run; the chip is left to the caller.
Manifest manifest_of_recording(const traces::WorkTrace& trace);

/// The replay of a trace, with `overrides` of the chip of the recording or of options.platform.
RunRecord replay_record(const std::string& trace, const RecordOptions& options,
                        RunFiles* files = nullptr);

/// The rows of frames.csv; those of a native run have no times.
/// @throws InputError for a table that cannot be read
std::vector<RecordedFrame> read_frames(const std::filesystem::path& file, const std::string& csv);

}  // namespace leviosim::tools
