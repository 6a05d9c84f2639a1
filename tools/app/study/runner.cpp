#include "tools/app/study/runner.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <mutex>
#include <unordered_map>
#include <utility>

#include "sim/base/interruption.h"
#include "sim/base/threads.h"
#include "sim/outputs/file_system.h"
#include "tools/app/cli/cache_folder.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/study/outcome_cache.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

/// The one that commands use unless told otherwise.
fs::path default_outcome_cache() { return cache_folder() / "outcomes"; }

constexpr std::int64_t kMostJobs = 1024;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// The points of equal keys as chains.
struct Chains {
  std::vector<std::size_t> firsts;  ///< in their order
  std::vector<std::size_t> next;    ///< by point; kNone after the last
};

Chains chains_of(const std::vector<std::string>& keys) {
  constexpr std::size_t kKeysPerPoll = 1024;
  Chains chains{{}, std::vector<std::size_t>(keys.size(), kNone)};
  std::unordered_map<std::string_view, std::size_t> last;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i % kKeysPerPoll == 0) throw_if_interrupted();
    const auto [it, is_new] = last.try_emplace(keys[i], i);
    if (is_new)
      chains.firsts.push_back(i);
    else
      chains.next[std::exchange(it->second, i)] = i;
  }
  return chains;
}

void show(ProgressLine& line, const std::string& noun, const Tally& tally) {
  line.show(static_cast<std::int64_t>(tally.done()), static_cast<std::int64_t>(tally.total),
            [&] { return progress_text(noun, tally, line.host_seconds()); });
}

}  // namespace

void add_jobs_option(CLI::App& command, std::string& jobs, const std::string& noun) {
  TextOptions{command}("--jobs", jobs, "N", noun + "s at a time [cores of the host]");
}

unsigned parse_jobs(const std::string& jobs) {
  return jobs.empty() ? 0 : static_cast<unsigned>(parse_whole("--jobs", jobs, 1, kMostJobs));
}

void add_runner_options(CLI::App& command, RunnerArguments& words, const std::string& noun) {
  add_jobs_option(command, words.jobs, noun);
  TextOptions{command}("--cache", words.cache, "DIR",
                       fmt::format("where finished {}s are cached [user's cache]", noun));
}

RunnerOptions runner_options(const RunnerArguments& words, const std::string& noun, bool quiet) {
  RunnerOptions options{.noun = noun,
                        .threads = parse_jobs(words.jobs),
                        .progress = ProgressLine::style_of_stderr(quiet)};
  options.cache =
      words.cache.empty() ? default_outcome_cache() : std::filesystem::path(words.cache);
  return options;
}

std::string progress_text(const std::string& noun, const Tally& tally, double host_seconds) {
  std::string text = fmt::format("{} {}/{}", noun, tally.done(), tally.total);
  const std::size_t before = tally.before + tally.found;
  if (before > 0) text += fmt::format(", {} of them done before", before);
  const auto computed = static_cast<double>(tally.computed);
  const auto left = static_cast<double>(tally.total - tally.done());
  if (computed > 0 && host_seconds > 0)
    text += fmt::format(", {:.1f} {}s/s, done in {}", computed / host_seconds, noun,
                        duration_text(left * host_seconds / computed));
  return text;
}

void run_all(std::size_t points, const RunnerOptions& options,
             const std::function<void(std::size_t)>& compute) {
  ProgressLine line(options.progress);
  std::mutex mutex;
  Tally tally{.total = points};
  base::parallel_for(points, options.threads, [&](std::size_t point) {
    compute(point);
    const std::lock_guard<std::mutex> lock(mutex);
    ++tally.computed;
    show(line, options.noun, tally);
  });
}

Tally run_points(const PointBatch& batch, const RunnerOptions& options) {
  const Chains chains = chains_of(batch.keys);
  const OutcomeCache cache(options.cache);
  ProgressLine line(options.progress);
  std::mutex mutex;
  Tally tally{.total = batch.before + batch.keys.size(), .before = batch.before};
  base::parallel_for(chains.firsts.size(), options.threads, [&](std::size_t chain) {
    const std::size_t first = chains.firsts[chain];
    std::optional<RunRecord> outcome = cache.find(batch.keys[first]);
    std::size_t& count = outcome ? tally.found : tally.computed;
    if (!outcome) {
      outcome = batch.compute(first);
      if (batch.keeps_failures || outcome->failure.empty())
        cache.store(batch.keys[first], *outcome);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (std::size_t point = first; point != kNone; point = chains.next[point]) {
      batch.take(point, *outcome);
      ++count;
    }
    show(line, options.noun, tally);
  });
  return tally;
}

}  // namespace leviosim::tools
