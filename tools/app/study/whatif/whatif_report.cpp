#include "tools/app/study/whatif/whatif_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable.h"
#include "tools/app/html_report/key_figures.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/record.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/record_source.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/study.h"
#include "tools/app/study/whatif/whatif.h"
#include "tools/app/study/whatif/whatif_text.h"

namespace leviosim::tools {
namespace {

/// @param results  outlive the table
Columns<VariantResult> variant_columns(const std::vector<VariantResult>& results) {
  using R = const VariantResult&;
  const auto time = [](Banded FrameTimes::*figure) {
    return [=](R r) { return r.failure.empty() ? Cell(1e-6 * (r.times.*figure)) : Cell(); };
  };
  const auto word = [](std::string_view about) {
    return [about](R r) {
      for (const RunVerdict& verdict : r.verdicts.list)
        if (verdict.about == about) return std::string(verdict.word());
      return std::string(r.failure.empty() ? "" : "cannot run");
    };
  };
  const auto milliseconds = [](const char* title, const char* key) -> Head {
    return {.title = title, .key = key, .decimals = 4, .unit = "ms", .is_banded = true};
  };
  const auto name = [](R r) {
    return r.raised.empty() ? r.name : fmt::format("{},{}", r.name, fmt::join(r.raised, ","));
  };
  return {{{.title = "variant", .key = "variant", .is_setup = true}, name},
          {milliseconds("mean frame", "frame_mean_ms"), time(&FrameTimes::mean_ns)},
          {milliseconds("frame time of 99 %", "frame_p99_ms"), time(&FrameTimes::p99_ns)},
          {milliseconds("worst frame", "frame_worst_ms"), time(&FrameTimes::worst_ns)},
          {{.title = "sustainable rate",
            .key = "sustainable_fps",
            .decimals = 3,
            .unit = "frames/s",
            .more_is_better = true},
           [](R r) { return r.failure.empty() ? Cell(r.times.sustainable_rate()) : Cell(); }},
          {{.key = "frames"}, [](R r) { return r.frames; }},
          {{.title = "late frames", .key = "late"}, [](R r) { return r.times.late; }},
          {{.title = "verdict", .key = "verdict"},
           [](R r) { return r.failure.empty() ? r.verdict() : "cannot run"; }},
          {{.title = "time", .key = "time"}, word("time")},
          {{.title = "memory", .key = "memory"}, word("memory")},
          {{.title = "map", .key = "map"}, word("map")},
          {{.title = "energy per frame",
            .key = "energy_mj",
            .decimals = 6,
            .unit = "mJ",
            .is_banded = true},
           [](R r) { return r.energy_mj; }},
          {{.title = "area", .key = "area_mm2", .decimals = 4, .unit = "mm2"},
           [](R r) { return r.area_mm2; }},
          {{.key = "area"}, [](R r) { return r.is_whole_area ? "whole" : "at least"; }},
          {{.key = "computed"}, [](R r) { return r.is_run ? "run again" : "replayed"; }},
          {{.title = "why", .key = "why"},
           [&](R r) {
             return &r == &results.front() || !r.failure.empty() ? std::string()
                                                                 : reason_of(results.front(), r);
           }},
          {{.title = "failure", .key = "failure"}, [](R r) { return r.failure; }}};
}

// leviosim whatif: a recorded run on other chips, a row a variant; without a change, advice.

struct WhatIfOptions : StudyOptions {
  std::vector<std::string> words;  ///< the run, if the first one is one, and the changes
  std::string memory;

  /// Empty: the shipped flight. A folder is one in any case, and may be refused.
  std::string run() const;
  std::vector<std::string> changes() const {
    return {words.begin() + (run().empty() ? 0 : 1), words.end()};
  }
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
std::string recorded_flight(const Arguments& words, ProgressLine::Style style) {
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

/// The run that a what-if changes, and how to compute it again (empty where it cannot be).
struct StudiedRun {
  std::string name;
  SweepRow again;
};

StudiedRun studied_run(const std::string& run, SweepInputs& inputs, const Arguments& words,
                       ProgressLine::Style style) {
  if (run.empty()) {
    StudiedRun studied{"the shipped flight", {}};
    const SweepInputs::Trace& trace =
        inputs.keep_trace(studied.name, recorded_flight(words, style));
    studied.again = settings_of(*trace.work, {});
    return studied;
  }
  const std::string file = trace_of(run);
  if (file.empty())
    throw InputError(
        fmt::format("{}: holds no {}; expected the folder of a run with --record, or a work trace",
                    run, kWorkTraceFile));
  const traces::WorkTrace& trace = *inputs.trace(run, {run}).work;
  if (!base::is_folder(run)) return {run, {}};
  const SweepRow again = settings_of(trace, read_run_folder(run, false).record.facts.workload);
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

/// Command lines that say more, each of which works.
std::vector<std::string> after(const std::string& run, const std::vector<std::string>& changes,
                               const std::vector<VariantResult>& results) {
  if (run.empty()) return {"leviosim run --record --out mine", "leviosim whatif mine"};
  const bool can_run = !changes.empty() && results.size() == 2 && results.back().failure.empty() &&
                       results.back().raised.empty() && !results.back().is_run &&
                       !changes.front().starts_with("isa.base=");  // of the chip's own file
  if (can_run && changes.front().find('=') != std::string::npos &&
      changes.front().find(':') == std::string::npos &&
      changes.front().find(',') == std::string::npos)
    return {fmt::format("leviosim compare {} -p {}", shell_word(run), shell_word(changes.front()))};
  return {fmt::format("leviosim whatif {} --report whatif.html", shell_word(run))};
}

std::string WhatIfOptions::run() const {
  const bool names_run =
      !words.empty() && (is_run(words.front()) || base::is_folder(words.front()));
  return names_run ? words.front() : std::string();
}

Answer answer(const WhatIfOptions& typed, const RunnerOptions& runner, const Arguments& words) {
  const std::string name = typed.run();
  const std::vector<std::string> changes = typed.changes();
  SweepInputs inputs(std::filesystem::current_path(), runner.progress, trace_memory(typed.memory));
  // Refused before a flight is drawn, which takes a while.
  for (const std::string& change : changes)
    if (change.find('=') == std::string::npos) inputs.platform(change, {change});
  const StudiedRun studied = studied_run(name, inputs, words, runner.progress);
  WhatIf what_if(inputs, studied.name, studied.again);
  std::vector<Variant> variants;
  for (const std::string& change : changes)
    for (Variant& variant : what_if.variants(change)) variants.push_back(std::move(variant));
  const bool advises = changes.empty();
  if (advises) variants = what_if.standard_variants();
  const std::vector<VariantResult> results = what_if.results(variants, runner);
  const traces::WorkTrace& trace = *inputs.trace(studied.name, {studied.name}).work;
  const std::string head = heading(studied.name, trace.info(), trace.frames());
  Answer answer{.parts = {head + (advises ? advice_text(results) : whatif_table(results))},
                .conclusion = advises ? advice_conclusion(results) : whatif_conclusion(results),
                .next = after(name, changes, results),
                .rows = whatif_rows(results)};
  answer.page.title = fmt::format("What if: {} on {}", trace.info().profile, trace.info().platform);
  const std::string& said = answer.conclusion;  // behind "in short: "
  answer.page.boxes.push_back(
      {{}, advises ? "Advice" : "Answer", said.substr(said.find(": ") + 2), {}});
  answer.page.summary = head;
  answer.page.bars = {"variant", {"frame_mean_ms", "energy_mj", "area_mm2"}};
  answer.page.x = "area_mm2";
  answer.page.y = "frame_mean_ms";
  answer.is_met = advises || std::all_of(results.begin(), results.end(),
                                         [](const auto& r) { return r.failure.empty(); });
  return answer;
}

void declare(CLI::App& command, WhatIfOptions& options) {
  command
      .add_option("RUN CHANGE", options.words,
                  "folder of a run with --record, or a work trace [the shipped flight]; then "
                  "changes: PATH=V,V…, a platform, PLATFORM:PATH=V,PATH=V")
      ->type_name("");
  add_memory_option(command, options.memory);
  command.add_flag("--quiet", options.quiet, "no progress");
}

const Study kWhatIf{
    "whatif",
    "A recorded run on other chips; without a change, advice",
    "variant",
    {"leviosim whatif recorded cluster.fpu.units=2,4,8 gap9-eigen", "leviosim whatif recorded"}};

}  // namespace

std::string whatif_bars(const std::vector<VariantResult>& results) {
  constexpr double kBar = 34;
  double longest = 0;
  for (const VariantResult& r : results) longest = std::max(longest, r.mean_ms());
  std::string text;
  for (const VariantResult& r : results) {
    text += fmt::format("{:<22}{:6.2f} ms {:5.2f} mJ ", r.name, r.mean_ms(),
                        r.energy_mj ? r.energy_mj->value : 0);
    for (int n = static_cast<int>(longest > 0 ? kBar * r.mean_ms() / longest + 0.5 : 0); n > 0; --n)
      text += "█";
    text += '\n';
  }
  return text;
}

Table whatif_rows(const std::vector<VariantResult>& results) {
  return table_of(variant_columns(results), results);
}

Command add_whatif_command(CLI::App& app, const Arguments& words) {
  return add_study<WhatIfOptions>(
      app, words, kWhatIf, declare,
      [](const WhatIfOptions& options) {
        const std::string run = options.run();
        return run.empty() ? std::vector<std::filesystem::path>{}
                           : std::vector<std::filesystem::path>{trace_of(run)};
      },
      answer);
}

}  // namespace leviosim::tools
