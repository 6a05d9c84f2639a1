#include "tools/commands/chip_studies.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/host.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/study/feasibility/feasibility_report.h"
#include "tools/app/study/systems/predictions.h"
#include "tools/app/study/systems/published_systems.h"
#include "tools/app/study/systems/systems_report.h"

namespace leviosim::tools {
namespace {

/// Computes the work and times it on the chips: on all workers of each, and, if `alone`, on one.
std::vector<Feasibility> rows_for(const ChipStudyOptions& options, const RunnerOptions& runner,
                                  bool alone) {
  const RunOptions& run = options.run;
  const std::vector<std::string> names =
      options.names.empty() ? platform::platform_names() : options.names;
  const SplitOverrides overrides = split_overrides(run.overrides);
  RunOptions recording = run;
  recording.platform = "gap9";
  recording.overrides = overrides.workload;
  RunRequest request = make_chip_request(recording);
  std::vector<FeasibilityPoint> points;
  for (const std::string& name : names) {
    try {
      const platform::ResolvedPlatform chip = platform::resolve_platform(name, overrides.chip);
      const int workers = chip.config.cluster.workers;
      points.push_back({name, chip, workers});
      if (alone && workers > 1) points.push_back({name, chip, 1});
    } catch (const InputError& error) {
      points.push_back({name, {}, 0, error.what()});
    }
  }
  request.data = data_folder(run, runner.progress);
  ProgressLine line(runner.progress);
  FeasibilityStudy study(request, shown_on(line));
  return study.on(points, runner);
}

/// What a study of chips reads.
std::vector<std::filesystem::path> inputs_of(const ChipStudyOptions& options) {
  std::vector<std::filesystem::path> inputs = data_inputs(options.run.data);
  inputs.insert(inputs.end(), options.names.begin(), options.names.end());
  return inputs;
}

/// The workload on a chip.
std::string run_on(const std::string& platform, const RunOptions& options) {
  return fmt::format("leviosim run --platform {} --profile {} --data {} --out mine",
                     shell_word(platform), options.profile, shell_word(options.data));
}

/// On the first chip that has the memory.
std::vector<std::string> next_for(const std::vector<Feasibility>& rows, const RunOptions& options) {
  for (const Feasibility& row : rows)
    if (row.fits()) return {run_on(row.platform, options)};
  return {};
}

/// Takes out the chips that are too small, on which a run is refused.
/// @returns what to say of them
/// @throws InputError if they were asked for by name
std::string without_small_chips(std::vector<Feasibility>& rows, bool by_name) {
  std::string text;
  for (const Feasibility& row : rows) {
    if (row.fits()) continue;
    const std::string why = fmt::format("{}: {}", printable(row.platform), memory_verdict(row));
    if (by_name)
      throw InputError(
          fmt::format("platforms stages: {}; expected chips on which the workload runs (platforms "
                      "feasibility times it as though it fitted)",
                      why));
    text += fmt::format("left out: {}\n", why);
  }
  std::erase_if(rows, [](const Feasibility& row) { return !row.fits(); });
  if (rows.empty())
    throw InputError(
        "platforms stages: no chip can run the workload; leviosim platforms "
        "feasibility says what each lacks");
  return text;
}

}  // namespace

void time_feasibility(const ChipStudyOptions& options) {
  const RunOptions& run = options.run;
  run_study({"feasibility", "What a workload takes on chips", "chip", {}}, options.run,
            inputs_of(options), {}, [&](const RunnerOptions& runner) {
              const std::vector<Feasibility> rows = rows_for(options, runner, true);
              Answer answer{.parts = {fmt::format("{} on {}\n\n{}", run.profile,
                                                  printable(run.data), feasibility_table(rows))},
                            .conclusion = feasibility_conclusion(rows),
                            .next = next_for(rows, run),
                            .rows = feasibility_rows(rows)};
              for (const Feasibility& row : rows)
                if (!options.names.empty() && !row.fits()) answer.is_met = false;
              return answer;
            });
}

void time_stages(const ChipStudyOptions& options) {
  run_study({"stages", "Stages of a workload on chips", "chip", {}}, options.run,
            inputs_of(options), {}, [&](const RunnerOptions& runner) {
              std::vector<Feasibility> rows = rows_for(options, runner, false);
              const std::string left_out = without_small_chips(rows, !options.names.empty());
              return Answer{
                  .parts = {fmt::format("{} on {}\n\n{}", options.run.profile,
                                        printable(options.run.data), stage_comparison(rows)),
                            left_out},
                  .conclusion = feasibility_conclusion(rows),
                  .next = next_for(rows, options.run),
                  .rows = stage_comparison_rows(rows)};
            });
}

void predict_published_systems(const ChipStudyOptions& options) {
  if (!options.run.overrides.empty())
    throw InputError("platforms systems: the chips are those of the systems; leave out --set");
  RunOptions any_chip = options.run;
  any_chip.platform = "gap9";
  RunRequest request = make_chip_request(any_chip);
  run_study({"systems", "Systems that estimate motion", "system", {}}, options.run,
            data_inputs(options.run.data), {}, [&](const RunnerOptions& runner) {
              request.data = data_folder(options.run, runner.progress);
              ProgressLine line(runner.progress);
              const std::vector<SystemRow> rows =
                  predict_systems(published_systems(), request, shown_on(line));
              return Answer{
                  .parts = {fmt::format("systems that estimate motion; predictions on {}\n\n{}",
                                        printable(options.run.data), systems_table(rows))},
                  .conclusion = systems_conclusion(rows),
                  .next = {"leviosim platforms feasibility"},
                  .rows = systems_rows(rows),
                  .page = systems_page(rows)};
            });
}

}  // namespace leviosim::tools
