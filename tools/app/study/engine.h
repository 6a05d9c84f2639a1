// A point of a study, and the key under which its outcome is kept.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/schema.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/record/record.h"
#include "tools/app/run/run_request.h"
#include "traces/datasets/dataset.h"
#include "traces/work_traces/work_trace.h"

namespace CLI {
class App;
}

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

// Records of finished points on disk (record/record.h, Level::figures), those of all studies
// together: one small file each, written whole or not at all, found by its key. A file begins with
// its key and a digest of the rest: what is damaged or lies under another key's name counts as
// absent, and is written anew. Several programs may use one folder at the same time.

class OutcomeCache {
 public:
  /// The folder is made when something is stored.
  explicit OutcomeCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing if the point is not there, or cannot be read.
  std::optional<RunRecord> find(const std::string& key) const;
  /// @throws InputError if it cannot be written
  void store(const std::string& key, const RunRecord& outcome) const;

 private:
  std::optional<std::string> find_text(const std::string& key) const;
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
};

// How the points of a study are run: on all cores of the host, with progress, until an interrupt.
// Outcomes are found again if they have been computed before, and kept as soon as they are there.

/// Options of a command, as typed.
struct RunnerWords {
  std::string jobs;
  std::string cache;
};

struct RunnerOptions {
  std::string noun = "run";  ///< what a point is called
  unsigned threads = 0;      ///< 0: as many as the host has; no outcome depends on it
  std::filesystem::path cache{};
  ProgressLine::Style progress = ProgressLine::Style::None;
};

/// --jobs alone, for studies that keep no outcomes. @param noun  what a point is called
void add_jobs_option(CLI::App& command, std::string& jobs, const std::string& noun);
/// RunnerOptions::threads. @throws InputError naming the option
unsigned parse_jobs(const std::string& jobs);

/// --jobs and --cache. @param noun  what a point is called
void add_runner_options(CLI::App& command, RunnerWords& words, const std::string& noun);
/// @throws InputError naming the option
RunnerOptions runner_options(const RunnerWords& words, const std::string& noun, bool quiet);

/// Points of a study.
struct Tally {
  std::size_t total = 0;
  std::size_t before = 0;  ///< finished when the study began
  std::size_t found = 0;   ///< in the cache
  std::size_t computed = 0;
  std::size_t done() const { return before + found + computed; }
};

/// "run 12/100, 3 of them done before, 4.1 runs/s, done in 0:00:21". No time before something was
/// computed.
std::string progress_text(const std::string& noun, const Tally& tally, double host_seconds);

/// Points whose outcomes are not kept. @param compute  called by several threads, once per point
/// @throws what compute() throws, Interrupted
void run_all(std::size_t points, const RunnerOptions& options,
             const std::function<void(std::size_t point)>& compute);

/// Points whose outcomes are kept, numbered as their keys.
struct PointBatch {
  std::vector<std::string> keys{};  ///< points of equal keys are computed once
  std::size_t before = 0;           ///< further points of the study, which are finished
  bool keeps_failures = true;       ///< in the cache
  /// Called by several threads.
  std::function<RunRecord(std::size_t point)> compute{};
  /// Called by one thread at a time, once per point, in the order in which they end.
  std::function<void(std::size_t point, const RunRecord& outcome)> take{};
};

/// What is finished is in the cache and taken, whatever becomes of the rest.
/// @throws what compute() and take() throw, Interrupted
Tally run_points(const PointBatch& batch, const RunnerOptions& options);

// How outcomes are condensed: a figure over several runs that differ by their random draws or
// texture worlds, and over several sequences.

/// Median, least and greatest. A run that failed counts as infinitely bad, so what it makes
/// infinite does not exist here.
struct Spread {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::optional<double> median;
  std::optional<double> low;
  std::optional<double> high;
};

/// @param values  of the runs; nothing for one that failed
Spread spread_of(const std::vector<std::optional<double>>& values);

/// Where the median of all that values could have been drawn from lies: between two of the values,
/// as far from the least as from the greatest.
struct MedianInterval {
  std::size_t values = 0;
  /// Of values that are drawn independently of each other: 1 - 2 P(fewer than k of n throws of a
  /// coin are heads), for the k-th value from either end of n. 0 for fewer than two values.
  double confidence = 0;
  std::optional<double> low;  ///< none where it is infinite, as with Spread
  std::optional<double> high;
};

/// The narrowest interval of at least this confidence; if no interval has it, from the least to the
/// greatest, with the confidence of that.
MedianInterval median_interval(const std::vector<std::optional<double>>& values,
                               double confidence = 0.95);

/// The values of a figure. @param of  figure of an outcome
template <class Outcomes, class Of>
std::vector<std::optional<double>> values_of(const Outcomes& outcomes, const Of& of) {
  std::vector<std::optional<double>> values;
  for (const auto& outcome : outcomes) values.push_back(std::invoke(of, outcome));
  return values;
}

/// None if one of them does not exist.
std::optional<double> mean_of(const std::vector<std::optional<double>>& values);

}  // namespace leviosim::tools
