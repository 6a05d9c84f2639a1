// leviosim whatif: a recorded run on other chips, a row a variant; without a change, advice.
#include "tools/commands/commands.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable_text.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/comparison/record_source.h"
#include "tools/app/html_report/report_file.h"
#include "tools/app/report/table_document.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/whatif/whatif_report.h"

namespace leviosim::tools {
namespace {

struct WhatIfWords {
  std::vector<std::string> words;  ///< the run, if the first one is one, and the changes
  std::string report;
  std::string jobs;
  std::string memory;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// The settings that compute a run again.
SweepRow settings_of(const traces::WorkTrace& trace, const std::vector<std::string>& workload) {
  const traces::WorkTraceInfo& info = trace.info();
  SweepRow again{
      {"data", info.data},
      {"profile", info.profile},
      {"seed", fmt::format("{}", info.seed)},
      {"size", fmt::format("{}x{}", info.image_width, info.image_height)},
      {"frames", fmt::format("{}:{}", info.first_frame, info.first_frame + trace.frames())}};
  for (const std::string& set : workload) {
    const std::size_t equals = set.find('=');
    if (equals != std::string::npos) again[set.substr(0, equals)] = set.substr(equals + 1);
  }
  return again;
}

/// levio over the shipped flight on GAP9, as the demonstration runs it.
std::string recorded_flight(const Words& words, ProgressLine::Style style) {
  RunOptions options;
  options.platform = "gap9";
  options.data = "synthetic";
  RunRequest request = make_chip_request(options);
  request.data = data_folder(options, style);
  WorkRecording recording(request.cores);
  request.recording = &recording;
  simulate_with_progress(request, style);
  return work_trace_of(std::move(recording), options, request,
                       make_manifest(options, request, words));
}

/// The run that is asked about.
struct Asked {
  std::string name;
  SweepRow again;
};

Asked asked_of(const std::string& run, SweepInputs& inputs, const Words& words,
               ProgressLine::Style style) {
  if (run.empty()) {
    Asked asked{"the shipped flight", {}};
    const SweepInputs::Trace& trace = inputs.keep_trace(asked.name, recorded_flight(words, style));
    asked.again = settings_of(*trace.work, {});
    return asked;
  }
  const std::string file = trace_of(run);
  if (file.empty())
    throw InputError(
        fmt::format("{}: holds no {}; expected the folder of a run with --record, or a work trace",
                    run, kWorkTraceFile));
  const traces::WorkTrace& trace = *inputs.trace(run, {run}).work;
  if (!base::is_folder(run)) return {run, {}};
  const SweepRow again = settings_of(trace, read_run_folder(run).facts.workload);
  const bool is_there = trace.info().data == "synthetic" || base::exists(trace.info().data);
  return {run, is_there ? again : SweepRow()};
}

/// Whether a word names a run: not a change, which has '=' or is a platform.
bool is_run(const std::string& word) {
  return base::exists(word) && !trace_of(word).empty() && !word.ends_with(".yaml") &&
         !word.ends_with(".yml");
}

std::string heading(const std::string& run, const traces::WorkTraceInfo& info, int frames) {
  return fmt::format("{}: {}, {} frames of {}, recorded on {}, {} cores\n", printable(run),
                     printable(info.profile), frames, printable(info.data),
                     printable(info.platform), info.cores);
}

/// Command lines that say more.
std::vector<std::string> after(const std::string& run, const std::vector<std::string>& changes) {
  if (run.empty()) return {"leviosim run --record --out mine", "leviosim whatif mine"};
  for (const std::string& change : changes)
    if (change.find('=') != std::string::npos && change.find_first_of(",:") == std::string::npos)
      return {fmt::format("leviosim compare {} -p {}", printable(run), printable(change))};
  return {fmt::format("leviosim whatif {} --report whatif.html", printable(run))};
}

void run(const WhatIfWords& typed, const Words& words) {
  const ProgressLine::Style style = ProgressLine::style_of_stderr(typed.quiet);
  std::vector<std::string> changes = typed.words;
  std::string name;
  if (!changes.empty() && is_run(changes.front())) {
    name = changes.front();
    changes.erase(changes.begin());
  } else if (!changes.empty() && base::is_folder(changes.front())) {
    name = changes.front();  // refused below
  }
  std::optional<outputs::OutputFile> page =
      claimed_report(typed.report, typed.force,
                     name.empty() ? std::vector<std::filesystem::path>{}
                                  : std::vector<std::filesystem::path>{trace_of(name)});
  SweepInputs inputs(std::filesystem::current_path(), style, trace_memory(typed.memory));
  const RunnerOptions options{
      .noun = "variant", .threads = parse_jobs(typed.jobs), .progress = style};
  const Asked asked = asked_of(name, inputs, words, style);
  WhatIf what_if(inputs, asked.name, asked.again);
  std::vector<Variant> variants;
  for (const std::string& change : changes)
    for (Variant& variant : what_if.variants(change)) variants.push_back(std::move(variant));
  const bool advises = changes.empty();
  if (advises) variants = what_if.standard_variants();
  const std::vector<VariantResult> results = what_if.results(variants, options);
  const traces::WorkTrace& trace = *inputs.trace(asked.name, {asked.name}).work;
  const std::string head = heading(asked.name, trace.info(), trace.frames());
  print(printout(
      typed.json,
      [&] {
        return Printout(head + (advises ? advice_text(results) : whatif_table(results)))
            .ending(whatif_conclusion(results), after(name, changes));
      },
      [&] { return table_document("whatif", whatif_csv(results)); }));
  if (page) publish_report(page, whatif_page("What if", head, results), !typed.json);
  const bool failed = std::any_of(results.begin(), results.end(),
                                  [](const VariantResult& r) { return !r.failure.empty(); });
  if (failed && !advises) throw LimitNotMet();
}

}  // namespace

Command add_whatif_command(CLI::App& app, const Words& words) {
  CLI::App* command =
      app.add_subcommand("whatif", "A recorded run on other chips; without a change, advice");
  const auto typed = std::make_shared<WhatIfWords>();
  command
      ->add_option("RUN CHANGE", typed->words,
                   "folder of a run with --record, or a work trace [the shipped flight]; then "
                   "changes: PATH=V,V…, a platform, PLATFORM:PATH=V,PATH=V")
      ->type_name("");
  add_report_option(*command, typed->report);
  command->add_flag("--force", typed->force, "replace that file");
  add_jobs_option(*command, typed->jobs, "variant");
  add_memory_option(*command, typed->memory);
  command->add_flag("--quiet", typed->quiet, "no progress");
  add_json_option(*command, typed->json);
  add_examples(*command, {"leviosim whatif recorded cluster.fpu.units=2,4,8 gap9-eigen",
                          "leviosim whatif recorded"});
  return {command, [=, &words] { run(*typed, words); }};
}

}  // namespace leviosim::tools
