#include "tools/app/run/record_source.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/record/measured.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/replay_report.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/workload_options.h"

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

RunFolder computed_run(const std::string& name, const RunRequest& request, const Manifest& manifest,
                       const Compute& compute, bool quiet) {
  ProgressLine line(ProgressLine::style_of_stderr(quiet));
  return run_folder(name, std::make_shared<const RunResult>(compute(request, shown_on(line))),
                    manifest, platform::to_yaml(request.platform));
}

Manifest manifest_of_recording(const traces::WorkTrace& trace) {
  Manifest manifest;
  manifest.seed = trace.info().seed;
  manifest.data = trace.info().data;
  manifest.first_frame = static_cast<std::size_t>(trace.info().first_frame);
  manifest.recording = recording_json(trace, "");  // which names the digests of the data
  return manifest;
}

RunFolder replayed_run(const std::string& name, const RecordOptions& options) {
  const traces::WorkTrace trace(name, trace_memory(options.memory));
  Manifest manifest = manifest_of_recording(trace);
  manifest.platform = options.platform.empty() ? trace.info().platform : options.platform;
  manifest.overrides = options.overrides;
  return computed_run(
      name, request_for(trace, options), manifest,
      [&](const RunRequest& request, const ProgressCallback& progress) {
        return replay(trace, request, progress).run;
      },
      options.quiet);
}

RunFolder read_run(const std::string& name, const RecordOptions& options, bool with_tables) {
  const std::filesystem::path path(name);
  if (!base::exists(path))
    throw InputError(
        fmt::format("{}: does not exist; expected a run folder or a work trace", name));
  if (is_measured(name)) {
    if (options.names_chip())
      throw InputError(
          fmt::format("{}: was measured on a chip; leave out --platform, -p and --cores", name));
    return {read_measured(name), {}};
  }
  if (base::is_folder(path) && !options.names_chip()) return read_run_folder(name, with_tables);
  const std::string trace = trace_of(name);
  if (trace.empty())
    throw InputError(
        fmt::format("{}: holds no {}, so it cannot be replayed on another chip; expected the "
                    "folder of a run with --record, or leave out --platform, -p and --cores",
                    name, kWorkTraceFile));
  return replayed_run(trace, options);
}

RunRecord read_record(const std::string& name, const RecordOptions& options) {
  return read_run(name, options, false).record;
}

}  // namespace leviosim::tools
