// `leviosim validate`: the paper's tables beside those of a run; with --fit, what factor on all
// instructions a fit to them would ask for.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/validation/as_released.h"
#include "tools/app/validation/calibration/calibration.h"
#include "tools/app/validation/validation.h"
#include "tools/app/validation/validation_report.h"
#include "tools/commands/commands.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

constexpr const char* kNotExamined = "not examined yet";

/// The folder of the run, with what was found out about it.
void write_folder(outputs::OutputFolder& out, const Validation& validation, const RunResult& run,
                  const Manifest& manifest, const std::string& platform) {
  write_run_folder(out, run_folder(out.shown_path(), std::make_shared<const RunResult>(run),
                                   manifest, platform));
  out.write("validation.csv", validation_csv(validation));
  out.write("validation.json", json_text(validation_json(validation), 2) + '\n');
  std::vector<std::optional<double>> values;
  for (const Comparison& comparison : validation.comparisons) values.push_back(comparison.value);
  out.write("paper.csv",
            updated_references("paper.csv", paper_references_text(), values, kNotExamined));
}

std::pair<RunResult, Validation> validated(RunRequest& request, ProgressLine::Style style) {
  FrameLog log(request.platform.config.cluster.core.code);
  request.observer = &log;
  request.time_bands = TimeBandsOf::team_and_one_core;
  RunResult result = simulate_with_progress(request, style);
  Validation validation = validate(result, log, profile_of(request), paper_references());
  request.observer = nullptr;
  return {std::move(result), std::move(validation)};
}

struct ValidateOptions : RunOptions {
  bool fit = false;
};

void fit(const RunOptions& options) {
  if (!options.out.empty())
    throw InputError("validate: --fit prints a table and writes nothing; leave out --out");
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

void validate(const RunOptions& given, const Arguments& words) {
  const RunOptions options = as_released(given);
  RunRequest request = make_chip_request(options);
  const std::optional<RunOptions> second = paper_keypoints(options);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  std::optional<outputs::OutputFolder> out;
  if (!options.out.empty()) out.emplace(out_request(options));
  request.data = data_folder(options, style);
  auto computed = validated(request, style);
  const RunResult& result = computed.first;
  Validation& validation = computed.second;
  if (second) {
    RunRequest other = make_chip_request(*second);
    other.data = request.data;
    validation.with_paper_keypoints = part_with_paper_keypoints(validated(other, style).second);
  }
  const auto lines = [&] {
    std::vector<std::string> parts = validation_report(validation, result.cores);
    parts.front().insert(0, heading(options, result));
    return Printout(std::move(parts))
        .ending(validation_conclusion(validation),
                {fmt::format("leviosim run --platform {} --data {} --out mine",
                             shell_word(options.platform), shell_word(options.data))});
  };
  const Printout text = printout(options.json, lines,
                                 [&] { return json_text(validation_json(validation), 2) + '\n'; });
  if (!out) {
    print(text);
  } else {
    const Manifest manifest = make_manifest(options, request, words);
    publish(*out, text, [&] {
      write_folder(*out, validation, result, manifest, platform::to_yaml(request.platform));
    });
  }
  if (is_worse(validation)) throw LimitNotMet();
}

}  // namespace

Command add_validate_command(CLI::App& app, const Arguments& words) {
  CLI::App* command =
      app.add_subcommand("validate", "Compare a run with the tables of the LEVIO paper");
  const auto options = std::make_shared<ValidateOptions>();
  add_chip_run_options(*command, *options);
  command->add_flag("--fit", options->fit,
                    "in place of the tables: the factor on all instructions that a fit to them "
                    "would ask for (1 for a sound model; nothing is set by it)");
  TextOptions{*command}("--out", options->out, "DIR",
                        "folder for the results; must be new or empty");
  command->add_flag("--force", options->force, "replace the results of an earlier run");
  add_examples(*command,
               {"leviosim validate --data flight", "leviosim validate --data flight --fit",
                "leviosim validate --data flight -p isa.load_use_fraction=0.2 --out validated"});
  add_json_option(*command, options->json);
  return {command, [=, &words] {
            if (options->fit)
              fit(as_released(*options));
            else
              validate(*options, words);
          }};
}

}  // namespace leviosim::tools
