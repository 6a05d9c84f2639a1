// `leviosim replay`: a recorded run on another chip.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/record/record.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/replay_report.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_printout.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/timeline/requested_timeline.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct ReplayOptions : RunOptions {
  std::string trace;
  std::string memory;
  GateOptions gate;
  TimelineOptions timeline;
  std::string report;
};

/// Of a run folder its trace is taken.
std::filesystem::path trace_file(const std::string& name) {
  const std::filesystem::path path(name);
  if (!base::is_folder(path)) return path;
  if (!base::exists(path / kWorkTraceFile))
    throw InputError(
        fmt::format("{}: holds no {}; expected the folder of a run with --record, or a "
                    "work trace",
                    name, kWorkTraceFile));
  return path / kWorkTraceFile;
}

Replay with_progress(const traces::WorkTrace& trace, const RunRequest& request,
                     ProgressLine::Style style) {
  ProgressLine line(style);
  return replay(trace, request, shown_on(line));
}

void run(const CLI::App& command, ReplayOptions options, const Arguments& words) {
  require(command, "TRACE", "the work.trace of a run with --record, or its folder");
  require(command, "--out", "a folder for the results");
  check_print_options(options, options.gate.budget);
  const std::optional<Gate> gate = optional_gate(options.gate, {});
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  std::optional<outputs::OutputFile> page =
      claimed_report(options.report, options.force, {trace_file(options.trace)});
  outputs::OutputRequest wanted = out_request(options);
  wanted.inputs.push_back(trace_file(options.trace));
  outputs::OutputFolder out(wanted);
  const traces::WorkTrace trace(trace_file(options.trace), trace_memory(options.memory));
  RunRequest request = replay_request(trace, options);
  std::optional<RequestedTimeline> timeline = requested_timeline(options.timeline, wanted, request);
  request.time_bands = TimeBandsOf::team;
  if (timeline) request.observer = &timeline->observer();
  const auto replay = std::make_shared<const Replay>(with_progress(trace, request, style));
  const std::shared_ptr<const RunResult> run(replay, &replay->run);
  if (options.platform.empty()) options.platform = trace.info().platform;
  const Manifest manifest = replay_manifest(trace, digest_of_file(trace.name()), options, words);
  options.data = trace.info().data;
  RunFolder folder =
      run_folder(out.shown_path(), run, manifest, platform::to_yaml(request.platform));
  folder.others[kReplayFile] = replay_csv(*replay);
  publish(out, run_printout(options, *run, folder.record, replay_report(*replay, trace)),
          [&] { write_run_folder(out, folder); });
  if (timeline) timeline->publish(*run, !options.json);
  report_and_check(folder, page, gate, !options.json);
}

}  // namespace

Command add_replay_command(CLI::App& app, const Arguments& words) {
  CLI::App* command =
      app.add_subcommand("replay", "Time the recorded work of a run on another chip");
  const auto options = std::make_shared<ReplayOptions>();
  command->add_option("TRACE", options->trace, "work.trace of a run with --record, or its folder");
  add_chip_options(*command, *options, " [that of the recording]");
  add_memory_option(*command, options->memory);
  command->add_flag("--quiet", options->quiet, "no progress");
  add_out_options(*command, *options);
  add_timeline_options(*command, options->timeline);
  add_gate_options(*command, options->gate);
  add_examples(*command, {"leviosim replay recorded -p cluster.fpu.units=1 --out one-fpu",
                          "leviosim replay recorded/work.trace --platform gap9-eigen --out eigen"});
  add_print_options(*command, *options);
  add_report_option(*command, options->report);
  return {command, [=, &words] { run(*command, *options, words); }};
}

}  // namespace leviosim::tools
