// `leviosim calibrate`: fits the code-generation constants of a platform.
#include "tools/commands/commands.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/run/run_session.h"
#include "tools/app/validation/calibration/calibration.h"
#include "tools/app/validation/validation.h"

namespace leviosim::tools {
namespace {

struct CalibrateOptions {
  RunOptions run;
  std::string constants = kDefaultConstants;
};

/// Loading takes what ends in .yaml for a file.
std::optional<outputs::OutputFile> claimed_platform_file(const RunOptions& options) {
  const std::string extension = std::filesystem::path(options.out).extension().string();
  if (!options.out.empty() && extension != ".yaml" && extension != ".yml")
    throw InputError(
        fmt::format("--yaml {}: expected a platform file that ends in .yaml", options.out));
  return claimed_file(out_request(options, "--yaml"));
}

void run(const CalibrateOptions& given) {
  CalibrateOptions options = given;
  options.run = as_released(given.run);
  RunRequest request = make_chip_request(options.run);
  const std::vector<std::string> constants = parse_constants("--constants", options.constants);
  const platform::Variants platform(request.platform);
  bounds_of(platform, constants);  // refuses constants without a range before the run
  std::optional<outputs::OutputFile> out = claimed_platform_file(options.run);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.run.quiet);
  request.data = data_folder(options.run, style);
  FrameLog log(request.platform.config.cluster.core.code);
  request.observer = &log;
  const RunResult result = simulate_with_progress(request, style);
  const Calibration calibration =
      calibrate(platform, stage_models(log, request.platform.config), constants);
  const std::string yaml =
      out ? platform::to_yaml(calibrated_platform(platform, calibration)) : std::string();
  publish({{out, yaml, "platform file"}},
          printout(
              options.run.json,
              [&] {
                std::vector<std::string> parts = calibration_report(calibration);
                parts.front().insert(0, heading(options.run, result));
                return Printout(std::move(parts))
                    .ending(calibration_conclusion(calibration), {"leviosim sensitivity"});
              },
              [&] { return json_text(calibration_json(calibration), 2) + '\n'; }));
}

}  // namespace

Command add_calibrate_command(CLI::App& app, const Words&) {
  CLI::App* command = app.add_subcommand(
      "calibrate", "Fit code-generation constants to the paper's single-core values");
  const auto options = std::make_shared<CalibrateOptions>();
  add_chip_run_options(*command, options->run);
  const TextOptions add{*command};
  add("--constants", options->constants, "PATH,…",
      fmt::format("up to {} [{}]", kMostConstants, kDefaultConstants));
  add("--yaml", options->run.out, "FILE", "platform file to write");
  command->add_flag("--force", options->run.force, "replace the file");
  add_examples(
      *command,
      {"leviosim calibrate --data flight --constants isa.instruction_overhead --yaml fitted.yaml"});
  add_json_option(*command, options->run.json);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
