#include "tools/app/study/engine.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/sha256.h"
#include "sim/base/threads.h"
#include "sim/outputs/file_system.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/json_reader.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/workload.h"
#include "traces/recordings/recording.h"
#include "traces/trajectories/evaluation.h"

namespace leviosim::tools {
namespace {

std::string workload_lines(const RunRequest& request) {
  std::string text = fmt::format("size {}x{}\nseed {}\nprofile {}\n", request.image_size.width,
                                 request.image_size.height, request.seed, request.profile);
  const std::vector<double> values = parameter_values(request);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const vio::Parameter& parameter = vio::parameters()[i];
    text += fmt::format("{} {}\n", parameter.name, value_text(parameter, values[i]));
  }
  return text;
}

std::string chip_lines(const RunRequest& request, const platform::Schema& schema) {
  std::string text =
      fmt::format("cores {}\n", request.cores) + canonical_text(schema, request.platform);
  if (!request.camera) return text;
  const auto& [fps, deadline] = *request.camera;
  return text + fmt::format("camera {} {}\n", fps ? fmt::format("{}", *fps) : "as recorded",
                            info_of(deadline).name);
}

namespace fs = std::filesystem;

double path_over_frames(const traces::Dataset& data) {
  double length = 0;
  for (std::size_t i = 1; i < data.ground_truth.size(); ++i) {
    const traces::GroundTruthPose& a = data.ground_truth[i - 1];
    const traces::GroundTruthPose& b = data.ground_truth[i];
    if (a.t_ns < data.frames.front().t_ns || b.t_ns > data.frames.back().t_ns) continue;
    length += (b.T_world_body.translation() - a.T_world_body.translation()).norm();
  }
  return length;
}

constexpr std::uint64_t kLargestFile = 64 << 20;

/// The first line of a file, by which it is known to be what was stored under the key.
std::string header_of(const std::string& key, const std::string& text) {
  return fmt::format("leviosim cache 3 {} {}\n", key, base::sha256_of(text));
}

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

std::vector<double> sorted_values(const std::vector<std::optional<double>>& values) {
  std::vector<double> sorted;
  for (const std::optional<double>& value : values)
    sorted.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

std::optional<double> finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string identity_of(const Point& point, const platform::Schema& schema) {
  std::string text = point.work + '\n';
  if (point.trace == nullptr) text += workload_lines(point.request);
  return text + (point.request.native ? "native\n" : chip_lines(point.request, schema));
}

std::string point_key(std::string_view kept, const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}\n{}", results_version(), kept, identity));
}

std::string folder_name(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

NamedFolder parse_named_folder(const std::string& text) {
  NamedFolder named{"", text};
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && !base::exists(text) && equals < text.find('/'))
    named = {text.substr(0, equals), text.substr(equals + 1)};
  else
    named.name = folder_name(text);
  if (named.name.empty() || named.name.find_first_of(",\"|\n\r") != std::string::npos)
    throw InputError(fmt::format(
        "--data {}: the sequence's name '{}' is empty or has a comma, quote or bar in it; expected "
        "NAME=DIR with another",
        text, named.name));
  return named;
}

/// Each file counts with its name.
std::string digest_of(const traces::Dataset& data) {
  base::Sha256 all;
  for (const InputDigest& file : digest_inputs(data))
    all.add(fmt::format("{} {}\n", file.name, file.sha256));
  return all.hex();
}

/// Frames may be equal, but not their times.
std::string work_of(const traces::Dataset& data, const std::string& digest) {
  return fmt::format("data {} {}:{}", digest, data.frames.front().t_ns, data.frames.back().t_ns);
}

Sequence open_sequence(const NamedFolder& named, const std::optional<traces::FrameRange>& frames,
                       const std::vector<traces::ImageSize>& sizes) {
  const traces::Dataset data = traces::open_recording(named.folder, {.frames = frames});
  if (data.ground_truth.empty())
    throw InputError(fmt::format("--data {}: has no ground truth", named.folder));
  std::vector<std::int64_t> stamps_ns;
  for (const traces::FrameRef& frame : data.frames) stamps_ns.push_back(frame.t_ns);
  traces::require_truth_at(data, stamps_ns);
  for (const traces::ImageSize& size : sizes) {
    try {
      traces::make_decimation(data.camera, size);
    } catch (const InputError& error) {
      throw InputError(fmt::format("--data {}: {}", named.folder, error.what()));
    }
  }
  const std::string digest = digest_of(data);
  return {named.name,           named.folder,           digest,
          data.frames.size(),   path_over_frames(data), traces::to_trajectory(data.ground_truth),
          work_of(data, digest)};
}

/// Folders of a few files each, also after a million runs.
fs::path OutcomeCache::file_of(const std::string& key) const {
  return folder_ / key.substr(0, 2) / (key + ".json");
}

std::optional<std::string> OutcomeCache::find_text(const std::string& key) const {
  const std::optional<std::string> bytes = outputs::try_read_file(file_of(key), kLargestFile);
  if (!bytes) return std::nullopt;
  const std::size_t end = bytes->find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string text = bytes->substr(end + 1);
  if (bytes->compare(0, end + 1, header_of(key, text)) != 0) return std::nullopt;
  return text;
}

std::optional<RunRecord> OutcomeCache::find(const std::string& key) const {
  const std::optional<std::string> text = find_text(key);
  const std::optional<Json> json = text ? try_read_json(*text) : std::nullopt;
  if (!json) return std::nullopt;
  try {
    return record_of_json("", *json, Level::figures);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void OutcomeCache::store(const std::string& key, const RunRecord& outcome) const {
  if (find_text(key)) return;  // another process was faster
  const std::string text = json_text(record_json(outcome)) + '\n';
  const fs::path file = file_of(key);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
  outputs::write_file_atomically(file, header_of(key, text) + text);
}

void add_jobs_option(CLI::App& command, std::string& jobs, const std::string& noun) {
  TextOptions{command}("--jobs", jobs, "N", noun + "s at a time [cores of the host]");
}

unsigned parse_jobs(const std::string& jobs) {
  return jobs.empty() ? 0 : static_cast<unsigned>(parse_whole("--jobs", jobs, 1, kMostJobs));
}

void add_runner_options(CLI::App& command, RunnerWords& words, const std::string& noun) {
  add_jobs_option(command, words.jobs, noun);
  TextOptions{command}("--cache", words.cache, "DIR",
                       fmt::format("where finished {}s are cached [user's cache]", noun));
}

RunnerOptions runner_options(const RunnerWords& words, const std::string& noun, bool quiet) {
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

Spread spread_of(const std::vector<std::optional<double>>& values) {
  Spread spread;
  for (const std::optional<double>& value : values) {
    ++spread.runs;
    if (!value) ++spread.failed;
  }
  const std::vector<double> sorted = sorted_values(values);
  if (sorted.empty()) return spread;
  spread.median = finite(0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]));
  spread.low = finite(sorted.front());
  spread.high = finite(sorted.back());
  return spread;
}

MedianInterval median_interval(const std::vector<std::optional<double>>& values,
                               double confidence) {
  const std::vector<double> sorted = sorted_values(values);
  const std::size_t count = sorted.size();
  MedianInterval interval;
  interval.values = count;
  if (count < 2) return interval;
  // The logarithm of the probability of k heads in `count` throws, which itself may be too small.
  double log_of_k = -static_cast<double>(count) * std::log(2.0);
  double fewer = std::exp(log_of_k);  // k heads or fewer
  std::size_t from_end = 0;
  interval.confidence = 1 - 2 * fewer;
  for (std::size_t k = 1; 2 * k + 1 < count; ++k) {
    log_of_k += std::log(static_cast<double>(count - k + 1) / static_cast<double>(k));
    fewer += std::exp(log_of_k);
    if (1 - 2 * fewer < confidence) break;
    interval.confidence = 1 - 2 * fewer;
    from_end = k;
  }
  interval.low = finite(sorted[from_end]);
  interval.high = finite(sorted[count - 1 - from_end]);
  return interval;
}

std::optional<double> mean_of(const std::vector<std::optional<double>>& values) {
  double sum = 0;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace leviosim::tools
