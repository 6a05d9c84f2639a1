// `leviosim trace info FILE` and `leviosim trace check FILE`: what a work trace holds, and whether
// all of it can be read.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/trace_report.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct TraceOptions {
  std::string action;
  std::string file;
  std::string memory;
  bool json = false;
};

/// Reads the summary only.
std::string trace_document(const traces::WorkTrace& trace) {
  const traces::WorkTraceInfo& info = trace.info();
  const Json document{{"format", "leviosim work trace"},
                      {"version", 1},
                      {"file", trace.name()},
                      {"program", info.program},
                      {"platform", info.platform},
                      {"cores", info.cores},
                      {"profile", info.profile},
                      {"seed", info.seed},
                      {"data", info.data},
                      {"first_frame", info.first_frame},
                      {"frames", trace.frames()},
                      {"image_width", info.image_width},
                      {"image_height", info.image_height},
                      {"frame_period_ns", info.frame_period_ns},
                      {"facts", info.facts},
                      {"bytes", trace.file_size()}};
  return json_text(document, 2) + '\n';
}

std::string after(const traces::WorkTrace& trace) {
  return fmt::format("leviosim whatif {}", shell_word(trace.name()));
}

void show_trace(const traces::WorkTrace& trace, bool json) {
  print(printout(
      json,
      [&] {
        return Printout(trace_summary(trace))
            .ending(fmt::format("in short: {} frames of {}, recorded on {} with {} cores",
                                trace.frames(), printable(trace.info().profile),
                                printable(trace.info().platform), trace.info().cores),
                    {after(trace)});
      },
      [&] { return trace_document(trace); }));
}

/// Everything that replay reads, its platform too.
void check_trace(const traces::WorkTrace& trace, bool json) {
  recorded_platform(trace);
  traces::WorkFrames reader(trace, true);
  for (traces::WorkFrame frame; reader.next(frame);) {
  }
  const auto lines = [&] {
    return Printout(fmt::format("work trace of {}\n", printable(trace.name())))
        .ending(fmt::format("verdict: met: all {} frames can be replayed", trace.frames()),
                {after(trace)});
  };
  print(printout(json, lines, [&] { return trace_document(trace); }));
}

void run(const CLI::App& command, const TraceOptions& options) {
  require(command, "ACTION", "info or check");
  require(command, "FILE", "a work trace");
  const Bytes memory = trace_memory(options.memory);
  if (options.action == "info")
    show_trace(traces::WorkTrace(options.file, memory), options.json);
  else if (options.action == "check")
    check_trace(traces::WorkTrace(options.file, memory), options.json);
  else
    throw InputError(fmt::format("trace: unknown action '{}'; expected info or check{}",
                                 options.action,
                                 base::did_you_mean(options.action, {"info", "check"})));
}

}  // namespace

Command add_trace_command(CLI::App& app, const Arguments&) {
  CLI::App* command = app.add_subcommand("trace", "Show what a work trace holds, or check it");
  const auto options = std::make_shared<TraceOptions>();
  command->add_option("ACTION", options->action, "info, or check: read all of it");
  command->add_option("FILE", options->file, "work.trace of a run with --record");
  add_memory_option(*command, options->memory);
  add_examples(*command, {"leviosim trace info recorded/work.trace",
                          "leviosim trace check recorded/work.trace"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
