#include "tools/run/run_command.h"

#include <fmt/core.h>

#include <memory>

#include "tools/cli/interrupts.h"
#include "tools/run/run_folder.h"
#include "tools/run/run_session.h"
#include "tools/run/tables.h"
#include "traces/atomic_file.h"

namespace leviosim::tools {
namespace {

void run(const CLI::App& command, const RunOptions& options, const Words& words) {
  RunRequest request = make_request(command, options);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  traces::StagedFolder staged(checked_out_folder(options.out, options.force));
  request.data = data_folder(options, style);
  const RunResult result = simulate_with_progress(request, style);
  write_run_folder(staged.path(), result, make_manifest(options, request, words),
                   request.native ? std::string() : platform::to_yaml(request.platform));
  throw_if_interrupted();
  staged.commit();
  fmt::print("{}{}results: {}\n", heading(options, result), report(result), options.out);
}

}  // namespace

Command add_run_command(CLI::App& app, const Words& words) {
  CLI::App* command = app.add_subcommand("run", "Run the workload on a chip, or natively");
  const auto options = std::make_shared<RunOptions>();
  add_run_options(*command, *options);
  return {command, [=, &words] { run(*command, *options, words); }};
}

}  // namespace leviosim::tools
