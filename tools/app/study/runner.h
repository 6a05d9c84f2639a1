// How the points of a study are run: on all cores of the host, with progress, until an interrupt.
// Outcomes are found again if they have been computed before, and kept as soon as they are there.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/app/cli/progress_line.h"
#include "tools/app/record/record.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// Options of a command, as typed.
struct RunnerArguments {
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
void add_runner_options(CLI::App& command, RunnerArguments& words, const std::string& noun);
/// @throws InputError naming the option
RunnerOptions runner_options(const RunnerArguments& words, const std::string& noun, bool quiet);

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

}  // namespace leviosim::tools
