#include "tools/run/run_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "tools/cli/interrupts.h"
#include "tools/cli/terminal.h"
#include "tools/cli/version.h"
#include "tools/replay/recording_source.h"
#include "tools/run/run_folder.h"
#include "tools/run/run_session.h"
#include "tools/run/tables.h"
#include "traces/atomic_file.h"

namespace leviosim::tools {
namespace {

/// What the run knows about itself beyond its work.
void complete(traces::WorkTraceInfo& info, const RunOptions& options, const RunRequest& request,
              const Manifest& manifest) {
  info.program = fmt::format("leviosim {} {}", version(), revision());
  info.seed = request.seed;
  info.data = options.data;
  info.first_frame = static_cast<std::int64_t>(manifest.first_frame);
  info.platform = fmt::format("{}", fmt::join(manifest.overrides, " "));
  info.platform =
      options.platform + (info.platform.empty() ? std::string() : " with " + info.platform);
  info.platform_yaml = platform::to_yaml(request.platform);
  for (const InputDigest& input : manifest.inputs)
    info.inputs.emplace_back(input.name, input.sha256);
}

void run(const CLI::App& command, const RunOptions& options, const Words& words) {
  RunRequest request = make_request(command, options);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  traces::StagedFolder staged(checked_out_folder(options.out, options.force));
  request.data = data_folder(options, style);
  WorkRecording recording(request.cores);
  if (options.record) request.recording = &recording;
  const RunResult result = simulate_with_progress(request, style);
  const Manifest manifest = make_manifest(options, request, words);
  write_run_folder(staged.path(), result, manifest,
                   request.native ? std::string() : platform::to_yaml(request.platform));
  if (options.record) {
    complete(recording.info, options, request, manifest);
    traces::write_file_atomically(staged.path() / kWorkTraceFile,
                                  recording.writer.finish(std::move(recording.info)));
  }
  throw_if_interrupted();
  staged.commit();
  print_result("{}{}results: {}\n", heading(options, result), report(result),
               printable(options.out));
}

}  // namespace

Command add_run_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand("run", "Run the workload on a chip, or natively");
  const auto options = std::make_shared<RunOptions>();
  add_run_options(*command, *options);
  return {command, [=, &words] { run(*command, *options, words); }};
}

}  // namespace leviosim::tools
