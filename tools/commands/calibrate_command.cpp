// `leviosim calibrate`: what a fit to the paper would ask for.
#include <CLI/CLI.hpp>

#include <memory>

#include "tools/app/cli/printout.h"
#include "tools/app/run/run_session.h"
#include "tools/app/validation/as_released.h"
#include "tools/app/validation/calibration/calibration.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

void run(const RunOptions& given) {
  const RunOptions options = as_released(given);
  RunRequest request = make_chip_request(options);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  request.data = data_folder(options, style);
  FrameLog log(request.platform.config.cluster.core.code);
  request.observer = &log;
  const RunResult result = simulate_with_progress(request, style);
  const std::vector<StageOnOneCore> stages = stages_on_one_core(log, request.platform.config);
  print(printout(
      options.json,
      [&] {
        return Printout({heading(options, result) + factor_table(stages)})
            .ending(factor_conclusion(stages), {"leviosim sensitivity"});
      },
      [&] { return json_text(factor_json(stages), 2) + '\n'; }));
}

}  // namespace

Command add_calibrate_command(CLI::App& app, const Words&) {
  CLI::App* command = app.add_subcommand(
      "calibrate", "Show what factor on all instructions a fit to the paper would ask for");
  const auto options = std::make_shared<RunOptions>();
  add_chip_run_options(*command, *options);
  add_examples(*command, {"leviosim calibrate --data flight",
                          "leviosim calibrate --data flight -p workload.fast_threshold=15 -p "
                          "workload.harris_threshold=4000"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
