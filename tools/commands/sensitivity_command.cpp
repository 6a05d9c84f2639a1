// `leviosim sensitivity`: which uncertain numbers of a platform matter.
#include "tools/commands/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "tools/app/cli/outputs.h"
#include "tools/app/report/table_document.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/trace_source.h"
#include "tools/app/study/sensitivity/sensitivity.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFramesByDefault = "0:100";

struct SensitivityOptions : RunOptions {
  std::string jobs;
};

void run(const SensitivityOptions& options) {
  const unsigned jobs = parse_jobs(options.jobs);
  RunRequest request = make_chip_request(options);
  std::optional<outputs::OutputFile> out = claimed_file(out_request(options, "--csv"));
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  request.data = data_folder(options, style);
  WorkRecording recording(request.cores);
  request.recording = &recording;
  const RunResult result = simulate_with_progress(request, style);
  const traces::WorkTrace trace("recorded run", recording.writer.finish(recording.info));
  const Sensitivity found =
      sensitivity(platform::Variants(std::move(request.platform)), request.cores, trace,
                  {.noun = "chip", .threads = jobs, .progress = style});
  publish({{out, sensitivity_csv(found), "table"}},
          printout(
              options.json,
              [&] {
                std::vector<std::string> parts = sensitivity_tables(found, result.cores);
                parts.front().insert(0, heading(options, result));
                return Printout(std::move(parts))
                    .ending(sensitivity_conclusion(found), {"leviosim microbench"});
              },
              [&] { return table_document("sensitivity", sensitivity_csv(found)); }));
}

}  // namespace

Command add_sensitivity_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "sensitivity", "Sweep every uncertain number of a chip over its range, one at a time");
  const auto options = std::make_shared<SensitivityOptions>();
  options->frames = kFramesByDefault;
  add_chip_run_options(*command, *options);
  TextOptions{*command}("--csv", options->out, "FILE", "write the rows to a file");
  command->add_flag("--force", options->force, "replace the file");
  add_jobs_option(*command, options->jobs, "chip");
  add_examples(*command,
               {"leviosim sensitivity --data flight --frames 0:20 --csv sensitivity.csv"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }, {{"--out", "--csv"}}};
}

}  // namespace leviosim::tools
