#include "tools/commands/trace_command.h"

#include <fmt/core.h>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/run/memory_option.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/trace_summary.h"

namespace leviosim::tools {
namespace {

struct TraceOptions {
  std::string action;
  std::string file;
  std::string memory;
};

/// Everything that replay reads, its platform too.
void check_trace(const traces::WorkTrace& trace) {
  recorded_platform(trace);
  traces::WorkFrames reader(trace, trace.has_offload());
  for (traces::WorkFrame frame; reader.next(frame);) {
  }
  print_result("{}: {} frames, all of them can be replayed\n", printable(trace.name()),
               trace.frames());
}

void run(const CLI::App& command, const TraceOptions& options) {
  require(command, "ACTION", "info or check");
  require(command, "FILE", "a work trace");
  const Bytes memory = trace_memory(options.memory);
  if (options.action == "info")
    print_result("{}", trace_summary(traces::WorkTrace(options.file, memory)));
  else if (options.action == "check")
    check_trace(traces::WorkTrace(options.file, memory));
  else
    throw InputError(fmt::format("trace: unknown action '{}'; expected info or check{}",
                                 options.action,
                                 base::did_you_mean(options.action, {"info", "check"})));
}

}  // namespace

Command add_trace_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("trace", "Show what a work trace holds, or check it");
  const auto options = std::make_shared<TraceOptions>();
  command->add_option("ACTION", options->action, "info, or check: read all of it");
  command->add_option("FILE", options->file, "work.trace of a run with --record");
  add_memory_option(*command, options->memory);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
