// What a sweep can vary: parameters of the chip and of the workload, and what else a run is asked.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "platform_models/loader/platform_file.h"
#include "platform_models/loader/value.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/record/record.h"
#include "tools/app/run/record_source.h"
#include "tools/app/run/yaml_map.h"
#include "tools/app/study/engine.h"
#include "traces/datasets/dataset.h"
#include "traces/work_traces/work_trace.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

class KnownRuns;  // known_runs.h

struct SweepKey {
  enum class Kind {
    chip,             ///< "platform.cluster.clock"
    instruction_set,  ///< "platform.isa.base"
    workload,         ///< "workload.window"
    platform,         ///< name or file
    profile,
    data,   ///< ASL folder or "synthetic"
    trace,  ///< of recorded work
    seed,
    size,
    frames,
    cores
  };
  Kind kind = Kind::chip;
  std::string name;                           ///< as in the plan
  std::string path{};                         ///< of the chip's parameter: without "platform."
  const vio::Parameter* parameter = nullptr;  ///< of the workload

  /// Whether it may be varied over a range.
  bool is_number(const platform::Schema& schema) const;
  /// Whether recorded work already says it, so that a sweep over a trace cannot set it.
  bool belongs_to_recording() const;
};

/// @throws InputError at `place` with the nearest valid name
SweepKey find_key(const std::string& name, const platform::Schema& schema,
                  const platform::Place& place);

/// A number of a key as the plan gives it, and in which unit: that of the chip's file, none for
/// others.
struct SweepNumber {
  double value = 0;
  double factor = 1;  ///< base units in one of the unit
  std::string unit;

  std::string text() const;
};

/// The text of a value as all later steps use it: checked, numbers of the chip in the unit that the
/// reference platform gives them.
/// @throws InputError at `place`
std::string normal_value(const SweepKey& key, const std::string& text,
                         platform::PlatformFile& reference, const platform::Place& place);

/// The same value as a number; only for keys that are numbers.
SweepNumber number_of(const SweepKey& key, const std::string& text,
                      platform::PlatformFile& reference, const platform::Place& place);

/// A number of the chip in its reference unit. @param base  in base units
SweepNumber chip_number(const SweepKey& key, double base, platform::PlatformFile& reference);

// The values of one key of a sweep: some that are named, or all of a range.

struct Span {
  double low = 0, high = 0;  ///< both included, in the unit
  bool logarithmic = false;  ///< evenly spread over the orders of magnitude
  bool whole = false;        ///< whole numbers of base units only
  double factor = 1;         ///< base units in one of the unit
  std::string unit;
};

struct Domain {
  std::vector<std::string> values;  ///< normal_value(); empty for a range
  std::optional<Span> span;
};

/// `[240, 370]`, `240`, `{ from: 100, to: 400, step: 10 }` or `{ from: 1, to: 16, scale: log }`
/// (without step, scale is `linear` unless given).
/// @param entry  of the map
Domain read_domain(const SweepKey& key, const YamlMap& map, const YamlMap::Entry& entry,
                   platform::PlatformFile& reference);

/// The value that lies at `u` of the domain, 0 <= u < 1; of equal u, equal values. Numbers of a
/// range have four digits, so that a point can be typed again.
std::string value_at(const Domain& domain, double u);

// What a plan names, opened once each: platforms, traces, folders of data. Paths in a plan are
// relative to its folder.

class SweepInputs {
 public:
  struct Trace {
    std::unique_ptr<traces::WorkTrace> work;
    std::string sha256;
    platform::PlatformFile platform;  ///< of the recording
  };
  struct Data {
    std::string folder;
    std::string work;  ///< work_of() the frames
    traces::CameraModel camera;
  };

  /// @param progress  of the synthetic flight, if it has to be made
  /// @param memory    that each reader of a trace may take
  SweepInputs(std::filesystem::path folder, ProgressLine::Style progress,
              Bytes memory = traces::kTraceMemory)
      : folder_(std::move(folder)), progress_(progress), memory_(memory) {}

  /// What is returned stays valid as long as this. Asking for what was opened before reads only, so
  /// several threads may.
  /// @throws InputError, which begins with `place`, for what cannot be opened
  platform::PlatformFile& platform(const std::string& name, const platform::Place& place);
  Trace& trace(const std::string& name, const platform::Place& place);
  /// A trace that is at hand, and has no file.
  Trace& keep_trace(const std::string& name, std::string bytes);
  const Data& data(const std::string& name, const std::string& frames,
                   const platform::Place& place);

 private:
  std::filesystem::path beside(const std::string& name) const;

  std::filesystem::path folder_;
  ProgressLine::Style progress_;
  Bytes memory_;
  std::map<std::string, platform::PlatformFile> platforms_;
  std::map<std::string, Trace> traces_;
  std::map<std::pair<std::string, std::string>, Data> data_;
};

// The folder of a sweep. Unlike other results it is added to, by several processes at a time, so it
// is no folder that appears whole (sim/outputs/output_folder.h): the file of points in it grows,
// and sweep.csv is a single file that only replaces what leviosim wrote.

class SweepFolder {
 public:
  struct Request {
    std::string option;  ///< that names the folder, for messages
    std::string path;
    std::vector<std::filesystem::path> inputs;  ///< that are read
    std::filesystem::path cache;                ///< may lie in the folder
  };
  /// Makes the folder if there is none.
  /// @throws InputError if it holds anything that no sweep wrote, which the message names, or an
  ///         input
  explicit SweepFolder(const Request& request);

  const std::filesystem::path& path() const { return path_; }
  /// To be published when all is done.
  outputs::OutputFile& csv() { return *csv_; }
  /// Begins anew: removes the points, of which others begin anew, too.
  void empty();

 private:
  void check_entry(const Request& request, const std::string& name) const;

  std::filesystem::path path_;
  std::optional<outputs::OutputFile> csv_;
};

// The file that a sweep is asked for in (README.md): what all points have in common, and groups of
// points. A group is the product of its members, the sweep all groups one after the other.
//
//   base: { trace: work.trace, platform: gap9 }
//   points:
//     - grid: { platform.cluster.clock: [240, 370] }
//
// All faults are InputErrors with file, line, key and the nearest valid name.

/// Values by the names of keys.
using SweepRow = std::map<std::string, std::string>;

struct SweepAxis {
  SweepKey key;
  platform::Place place;
  Domain domain;
};

struct SweepMember {
  enum class Kind { grid, list, random, latin_hypercube };
  Kind kind = Kind::grid;
  platform::Place place;
  std::vector<SweepAxis> axes;  ///< in the order of the file; of a list, only their keys
  std::vector<SweepRow> rows;   ///< of a list
  std::size_t count = 0;        ///< of random points
  std::uint64_t seed = 1;       ///< of their draws
};

struct SweepGroup {
  platform::Place place;
  std::vector<SweepMember> members;
};

struct SweepPlan {
  std::string file;
  std::string text;
  SweepRow base;
  std::map<std::string, platform::Place> base_places;
  std::vector<SweepGroup> groups;
  std::vector<SweepKey> keys;    ///< that groups set, each once, in the order of the file
  bool skip_impossible = false;  ///< points that contradict themselves are left out
  platform::PlatformFile* reference = nullptr;  ///< the inputs'
};

/// @param inputs  opens what the plan names; outlives the plan
SweepPlan read_plan(const std::string& file, SweepInputs& inputs);
/// The same from its text.
SweepPlan parse_plan(const std::string& file, const std::string& text, SweepInputs& inputs);

// The points of a group of a plan, in an order that depends on nothing but the plan.

/// A sweep has no more points than this.
inline constexpr std::size_t kMostPoints = 100'000;

/// One dimension of `count` points of the unit cube, drawn evenly, in [0, 1). A point does not
/// depend on how many there are.
std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// One dimension of a Latin hypercube (McKay, Beckman and Conover, Technometrics 21(2), 1979): if
/// it is cut into `count` equal strata, every stratum holds exactly one point.
std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// The rows of a group: the last key of a grid and the last member vary fastest.
/// @throws InputError for more than kMostPoints, Interrupted
std::vector<SweepRow> rows_of(const SweepGroup& group);

/// What a sweep keeps of a point, for point_key().
inline constexpr std::string_view kSweepFigures = "figures of a sweep";

struct ResolvedPoint : Point {
  platform::PlatformFile* chip = nullptr;  ///< the inputs'
  std::vector<std::string> overrides;      ///< of the chip
  std::string identity;                    ///< identity_of()
};

/// @param where  begins the messages
/// @throws InputError for a point that contradicts itself or its inputs
ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where);

/// What a key of the plan is at a point, set there or not.
struct PointParameter {
  std::string name;
  std::string text;                ///< "240MHz"
  std::optional<double> number{};  ///< toggles are 0 or 1; none for names
  std::string unit{};
};

struct SweepPoint {
  int number = 0;                          ///< from 1
  SweepRow settings;                       ///< with those of the base
  std::vector<PointParameter> parameters;  ///< in the order of SweepPlan::keys
  std::string key;                         ///< point_key()

  /// "platform.cluster.clock=240MHz workload.window=6".
  std::string settings_text() const;
};

struct Expansion {
  std::vector<SweepPoint> points;
  std::size_t asked = 0;           ///< points of the plan, repetitions included
  std::size_t impossible = 0;      ///< points that were left out, if the plan says skip
  std::string first_impossible{};  ///< why the first was
};

/// @throws InputError for points that cannot be, Interrupted
Expansion expand(const SweepPlan& plan, SweepInputs& inputs);

// What a sweep keeps of a point: all that a run or a replay says, as a list of figures.

/// What sweeps are judged by, first of all figures; less is better. A figure is missing where it
/// does not exist: energy and area of chips without such figures, the error without ground truth or
/// where the algorithm would have computed something else than was recorded.
struct Objective {
  const char* figure;
  const char* unit;
  const char* description;
  const char* statistic;  ///< that it is
  double factor;          ///< from the statistic's unit
  const char* title;      ///< of a column
  int decimals;
  double scale;  ///< for the column
};
inline constexpr std::array kObjectives{
    Objective{"objective.frame_time", "ms", "mean over all frames, each by itself",
              "frame.time.mean", 1e-6, "frame ms", 3, 1},
    Objective{"objective.energy", "mJ", "per frame, idle time included", "energy.frame", 1,
              "energy mJ", 4, 1},
    Objective{"objective.l1_peak", "byte", "highest of the cluster's stages", "memory.l1.peak", 1,
              "L1 peak kB", 1, 1e-3},
    Objective{"objective.ate", "m", "RMSE of the trajectory", "accuracy.ate.rmse", 1, "ATE m", 4,
              1},
    Objective{"objective.area", "mm2", "of the chip, without pads and analogue parts", "area.chip",
              1, "area mm2", 3, 1}};

/// Computes the point, or times its recorded work. A chip too small for the work is a failure.
/// @throws Interrupted
RunRecord run_point(const ResolvedPoint& point, KnownRuns& known);

// A point of a finished sweep as a run that can be compared: "swept:3". A sweep keeps figures only,
// not where cycles went, so the point is replayed or computed again, as the sweep's plan says.

/// "swept:3", where `swept` is the folder of a sweep.
struct PointName {
  std::string sweep;
  std::string number;  ///< as typed

  std::string text() const { return sweep + ':' + number; }
};

/// Nothing for all else, such as a folder that is called so.
/// @throws InputError for a sweep without a number, saying which there are
std::optional<PointName> point_name(const std::string& text);

/// @param memory,quiet  of the options; the chip is the point's
/// @throws InputError for a number that the sweep does not have, for points whose plan, trace or
///         data are no longer what they were, and as the run does
RunFolder read_point(const PointName& name, const RecordOptions& options);

}  // namespace leviosim::tools
