#include "tools/app/comparison/run_record.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/trace_source.h"
#include "tools/app/run/workload.h"

namespace leviosim::tools {
namespace {

RunRequest request_for(const traces::WorkTrace& trace, const RecordOptions& options) {
  if (const auto split = split_overrides(options.overrides); !split.workload.empty())
    throw InputError(
        fmt::format("{}: the recorded work is that of a workload as it was; leave out -p {}",
                    trace.name(), split.workload.front()));
  RunRequest request;
  request.platform = options.platform.empty()
                         ? recorded_platform(trace, options.overrides)
                         : platform::resolve_platform(options.platform, options.overrides);
  request.cores = options.cores.empty() ? trace.info().cores
                                        : cores_of(options, request.platform.config.cluster);
  return request;
}

std::vector<std::string> titles_of(const std::string& csv) {
  std::vector<std::string> titles(1);
  for (const char c : csv.substr(0, csv.find('\n'))) {
    if (c == ',')
      titles.emplace_back();
    else if (c != '\r')
      titles.back() += c;
  }
  return titles;
}

/// A CSV file whose first row holds the titles of its columns.
class FrameTable {
 public:
  FrameTable(const std::filesystem::path& file, const std::string& csv)
      : titles_(titles_of(csv)), reader_(file, base::Separator::comma, titles_, csv) {
    if (csv.empty() || csv.back() != '\n')
      throw InputError(fmt::format("{}: ends within a line: it was cut off", file.string()));
    reader_.next();  // the titles
  }

  bool has(std::string_view title) const {
    return std::find(titles_.begin(), titles_.end(), title) != titles_.end();
  }
  /// @throws InputError if there is none of that title
  std::size_t column(std::string_view title) const {
    if (!has(title))
      throw InputError(fmt::format("{}: has no column {}", reader_.file().string(), title));
    return static_cast<std::size_t>(std::find(titles_.begin(), titles_.end(), title) -
                                    titles_.begin());
  }
  const base::CsvRow* next() { return reader_.next(); }

 private:
  std::vector<std::string> titles_;
  base::CsvReader reader_;
};

/// The columns of frames.csv that are read; native runs have no latency.
struct FrameColumns {
  explicit FrameColumns(const FrameTable& table)
      : number(table.column("frame")),
        t_ns(table.column("t_ns")),
        source(table.column("source")),
        features(table.column("features")),
        restarts(table.column("map_restarts")),
        health(table.column("health")),
        health_reasons(table.column("health_reasons")) {
    if (table.has("latency_ns")) latency = table.column("latency_ns");
    if (table.has("state")) state = table.column("state");  // not in folders of older programs
    if (table.has("at_rest")) at_rest = table.column("at_rest");
  }

  std::size_t number, t_ns, source, features, restarts, health, health_reasons;
  std::optional<std::size_t> latency, state, at_rest;
};

int whole(const base::CsvRow& row, std::size_t column) {
  constexpr double kMost = 1e9;
  const double value = row.number(column);
  if (!(value >= 0 && value <= kMost && value == std::floor(value)))
    row.fail(column, "no whole number");
  return static_cast<int>(value);
}

/// Of a frame that was not dropped.
void read_result(const base::CsvRow& row, const FrameColumns& at, RecordedFrame& frame) {
  for (const vio::PoseSourceInfo& info : vio::kPoseSources)
    if (info.name == row.text(at.source)) frame.source = info.source;
  frame.features = whole(row, at.features);
  frame.map_restarts = whole(row, at.restarts);
  frame.health = whole(row, at.health);
  frame.health_reasons = whole(row, at.health_reasons);
  if (at.state) frame.state = vio::state_named(row.text(*at.state)).value_or(frame.state);
  frame.at_rest = at.at_rest && whole(row, *at.at_rest) > 0;
}

constexpr const char* kFrame = "frame";

/// All rows of a stage.
struct MeasuredStage {
  std::string name;
  double cycles = 0;
  double calls = 0;
  double worst = 0;
  std::size_t rows = 0;
};

/// What a comment "# KEY: value" says; empty if there is none.
std::string comment(std::string_view text, std::string_view key) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto trimmed = [&](std::string_view words) {
    const auto begin = words.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return std::string_view();
    return words.substr(begin, words.find_last_not_of(kBlanks) - begin + 1);
  };
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const auto colon = line.find(':');
    if (!line.starts_with('#') || colon == std::string_view::npos) continue;
    if (trimmed(line.substr(1, colon - 1)) == key)
      return std::string(trimmed(line.substr(colon + 1)));
  }
  return {};
}

void add_row(const base::CsvRow& row, bool has_calls, std::vector<MeasuredStage>& stages) {
  const std::string name(row.text(0));
  if (key_of(name).empty()) row.fail(0, "no name of a stage");
  const double cycles = row.number(1);
  const double calls = has_calls ? row.number(2) : 1;
  if (cycles < 0) row.fail(1, "below zero");
  if (calls < 1) row.fail(2, "below one");
  const auto known = std::find_if(stages.begin(), stages.end(), [&](const MeasuredStage& s) {
    return key_of(s.name) == key_of(name);
  });
  MeasuredStage& stage = known != stages.end() ? *known : stages.emplace_back();
  stage.name = name;
  stage.cycles += cycles * calls;
  stage.calls += calls;
  stage.worst = std::max(stage.worst, cycles);
  ++stage.rows;
}

std::vector<MeasuredStage> read_stages(const std::string& file, std::string text) {
  const base::FirstRow first = base::first_row(file);
  const bool has_calls = first.columns == 3;
  std::vector<std::string> names{"stage", "cycles"};
  if (has_calls) names.emplace_back("calls");
  base::CsvReader rows(file, base::Separator::comma, names, std::move(text));
  const base::CsvRow* const titles = rows.next();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (titles->text(i) != names[i])
      titles->fail("expected the titles stage,cycles or stage,cycles,calls");
  std::vector<MeasuredStage> stages;
  while (const base::CsvRow* row = rows.next()) add_row(*row, has_calls, stages);
  if (stages.empty())
    throw InputError(fmt::format("{}: has no measurement below its titles", file));
  for (MeasuredStage& stage : stages)
    if (!has_calls && stage.rows == 1) stage.calls = 0;  // a mean, of nobody knows how many
  return stages;
}

}  // namespace

void add_record_options(CLI::App& command, RecordOptions& options) {
  add_chip_options(command, options, ", on which traces are replayed [that of the recording]");
  add_memory_option(command, options.memory);
  command.add_flag("--quiet", options.quiet, "no progress");
}

std::string trace_of(const std::string& name) {
  const std::filesystem::path path(name);
  if (base::is_file(path)) return name;
  return base::is_folder(path) && base::exists(path / kWorkTraceFile)
             ? (path / kWorkTraceFile).string()
             : std::string();
}

RunRecord computed_record(const std::string& name, RunRequest request, const Manifest& manifest,
                          const Compute& compute, bool quiet, RunFiles* files) {
  ProgressLine line(ProgressLine::style_of_stderr(quiet));
  const RunResult run = compute(request, shown_on(line));
  if (files != nullptr) {
    *files = run_files(run, manifest, platform::to_yaml(request.platform));
    (*files)[kCyclesFile] = cycles_csv(cycle_parts(run));
  }
  return make_record(name, manifest, run, cycle_parts(run));
}

Manifest manifest_of_recording(const traces::WorkTrace& trace) {
  Manifest manifest;
  manifest.seed = trace.info().seed;
  manifest.data = trace.info().data;
  manifest.first_frame = static_cast<std::size_t>(trace.info().first_frame);
  manifest.recording = recording_json(trace, "");  // which names the digests of the data
  return manifest;
}

RunRecord replay_record(const std::string& name, const RecordOptions& options, RunFiles* files) {
  const traces::WorkTrace trace(name, trace_memory(options.memory));
  Manifest manifest = manifest_of_recording(trace);
  manifest.platform = options.platform.empty() ? trace.info().platform : options.platform;
  manifest.overrides = options.overrides;
  return computed_record(
      name, request_for(trace, options), manifest,
      [&](const RunRequest& request, const ProgressCallback& progress) {
        return replay(trace, request, progress).run;
      },
      options.quiet, files);
}

RunRecord read_record(const std::string& name, const RecordOptions& options, RunFiles* files) {
  const std::filesystem::path path(name);
  if (!base::exists(path))
    throw InputError(
        fmt::format("{}: does not exist; expected a run folder or a work trace", name));
  if (is_measured(name)) {
    if (options.names_chip())
      throw InputError(
          fmt::format("{}: was measured on a chip; leave out --platform, -p and --cores", name));
    return read_measured(name);
  }
  if (base::is_folder(path) && !options.names_chip()) {
    RunFiles read = read_run_files(path);
    RunRecord record = record_of_files(name, read);
    if (files != nullptr) *files = std::move(read);
    return record;
  }
  const std::string trace = trace_of(name);
  if (trace.empty())
    throw InputError(
        fmt::format("{}: holds no {}, so it cannot be replayed on another chip; expected the "
                    "folder of a run with --record, or leave out --platform, -p and --cores",
                    name, kWorkTraceFile));
  return replay_record(trace, options, files);
}

std::vector<RecordedFrame> read_frames(const std::filesystem::path& file, const std::string& csv) {
  FrameTable table(file, csv);
  const FrameColumns at(table);
  std::vector<RecordedFrame> frames;
  while (const base::CsvRow* row = table.next()) {
    RecordedFrame& frame = frames.emplace_back();
    frame.number = whole(*row, at.number);
    frame.t_ns = row->nanoseconds(at.t_ns);
    const bool is_dropped = at.latency && row->text(*at.latency).empty();
    if (!is_dropped) read_result(*row, at, frame);
  }
  return frames;
}

bool is_measured(const std::string& name) { return name.ends_with(".csv") && base::is_file(name); }

RunRecord read_measured(const std::string& file) {
  const std::string text = base::read_file(file, base::InputKind::table);
  RunRecord record;
  record.name = file;
  record.facts.measured = true;
  record.facts.profile = comment(text, "profile");
  record.facts.platform = comment(text, "platform");
  for (const MeasuredStage& stage : read_stages(file, text)) {
    const std::string key = key_of(stage.name);
    const double count = stage.calls > 0 ? stage.calls : 1;
    const bool is_frame = key == kFrame;
    const std::string path = is_frame ? "frame." : fmt::format("stages.{}.", key);
    const auto add = [&](const char* name, const char* unit, double value) {
      record.statistics.push_back({path + name, unit, "", value});
    };
    if (!is_frame) record.stages.push_back({stage.name, key, false});
    add("cycles.parallel.mean", "cycles", stage.cycles / count);
    if (is_frame || stage.calls == 0) continue;
    add("calls", "1", stage.calls);
    if (stage.rows > 1) add("cycles.parallel.worst", "cycles", stage.worst);
  }
  return record;
}

void name_stages_like(RunRecord& measured, const RunRecord& run) {
  if (!measured.facts.measured) return;
  for (StageName& stage : measured.stages)
    for (const StageName& known : run.stages)
      if (known.key == stage.key) stage.name = known.name;
}

}  // namespace leviosim::tools
