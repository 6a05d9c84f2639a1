// `leviosim run`: the workload on a chip, or natively, over recorded or synthetic data.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "tools/app/budget/gate.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/film/film.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/record/record.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_printout.h"
#include "tools/app/run/run_session.h"
#include "tools/app/timeline/requested_timeline.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct RunCommandOptions : RunOptions {
  GateOptions gate;
  TimelineOptions timeline;
  std::string report;
};

void run(RunCommandOptions options, const Arguments& words) {
  set_run_defaults(options);
  RunRequest request = make_request(options);
  check_print_options(options, options.gate.budget);
  const std::optional<Gate> gate = optional_gate(options.gate, {});
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  std::optional<outputs::OutputFile> page = claimed_report(options.report, options.force);
  const outputs::OutputRequest wanted = out_request(options);
  outputs::OutputFolder out(wanted);
  std::optional<RequestedTimeline> timeline = requested_timeline(options.timeline, wanted, request);
  request.data = data_folder(options, style);
  out.reserve(expected_bytes(request, options.record));
  const Manifest manifest = make_manifest(options, request, words);
  std::optional<outputs::Spool> trace;
  if (options.record) trace.emplace(out.spool(kWorkTraceFile));
  WorkRecording recording(request.cores, [&](std::string_view bytes) {
    if (trace) trace->add(bytes);
  });
  if (options.record) request.recording = &recording;
  std::optional<outputs::Spool> pictures;
  std::optional<FilmWriter> film;
  if (options.film) {
    pictures.emplace(out.spool(kFilmFile));
    film.emplace([&](std::string_view bytes) { pictures->add(bytes); });
    request.film = &*film;
  }
  request.time_bands = TimeBandsOf::team;
  if (timeline) request.observer = &timeline->observer();
  const auto result = std::make_shared<const RunResult>(simulate_with_progress(request, style));
  const RunFolder folder =
      run_folder(out.shown_path(), result, manifest,
                 request.native ? std::string() : platform::to_yaml(request.platform));
  const std::string remarks =
      film ? fmt::format("film: {:.2g} MB of images and features, for report --interactive\n",
                         static_cast<double>(film->size().count()) * 1e-6)
           : std::string();
  publish(out, run_printout(options, *result, folder.record, remarks), [&] {
    write_run_folder(out, folder);
    if (!options.record) return;
    work_trace_of(std::move(recording), options, request, manifest);
    out.write(kWorkTraceFile, trace->content());
    if (pictures) out.write(kFilmFile, pictures->content());
  });
  if (timeline) timeline->publish(*result, !options.json);
  report_and_check(folder, page, gate, !options.json);
}

}  // namespace

Command add_run_command(CLI::App& app, const Arguments& words) {
  CLI::App* command = app.add_subcommand("run", "Run the workload on a chip, or natively");
  const auto options = std::make_shared<RunCommandOptions>();
  add_run_options(*command, *options);
  add_timeline_options(*command, options->timeline);
  add_gate_options(*command, options->gate);
  add_report_option(*command, options->report);
  add_examples(*command,
               {"leviosim run --platform gap9 --data flight --record --out recorded",
                "leviosim run --platform gap9 -p cluster.clock=240MHz -p controller.clock=240MHz "
                "-p supply.voltage=0.65V --data flight --out slow",
                "leviosim run --platform gap9 --data flight --fps 10 --deadline drop --out loop",
                "leviosim run --native --data flight --size 320x240 --out golden"});
  add_print_options(*command, *options);
  return {command, [=, &words] { run(*options, words); }};
}

}  // namespace leviosim::tools
