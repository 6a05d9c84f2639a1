#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/comparison/run_record.h"
#include "tools/app/html_report/page.h"
#include "tools/app/report/statistic_list.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/study.h"
#include "tools/app/study/whatif/whatif.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr int kWidth = 80;
constexpr int kIndent = 4;
constexpr int kNameWidth = 28;
/// Per cent of the time; less is no change.
constexpr double kNoChange = 0.05;
/// Of the whole difference: a cause with less goes without saying.
constexpr double kLeastCause = 0.2;

std::optional<double> percent(double value, double base) {
  if (base == 0) return std::nullopt;
  return 100 * (value / base - 1);
}

struct Changes {
  double time = 0;
  std::optional<double> energy;
  std::optional<double> area;
};

Changes changes_of(const VariantResult& base, const VariantResult& variant) {
  Changes changes{percent(variant.mean_ms(), base.mean_ms()).value_or(0), {}, {}};
  if (base.energy_mj && variant.energy_mj)
    changes.energy = percent(variant.energy_mj->value, base.energy_mj->value);
  if (base.area_mm2 && variant.area_mm2) changes.area = percent(*variant.area_mm2, *base.area_mm2);
  return changes;
}

std::string wrapped(const std::string& text) {
  return std::string(kIndent, ' ') + wrap_words(text, kIndent, kWidth) + '\n';
}

std::string below(const VariantResult& base, const VariantResult& variant) {
  std::string text;
  if (display_width(printable(variant.name)) > kNameWidth) text = printable(variant.name) + ": ";
  if (!variant.failure.empty()) return wrapped(text + printable(variant.failure));
  const Changes changes = changes_of(base, variant);
  text += std::abs(changes.time) < kNoChange ? "same time"
                                             : fmt::format("{:+.1f} % time", changes.time);
  if (changes.energy) text += fmt::format(", {:+.1f} % energy", *changes.energy);
  if (!variant.is_whole_area)
    text += ", area of some parts unknown";
  else if (changes.area)
    text += fmt::format(", {:+.1f} % area", *changes.area);
  return wrapped(text + ": " + reason_of(base, variant));
}

std::string number(std::optional<double> value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "–";
}

std::vector<Cell> cells_of(const VariantResult& result) {
  const std::string name = shortened(printable(result.name), kNameWidth);
  if (!result.failure.empty()) return {name, "–", "–", "–", "cannot run", "–", "–"};
  std::optional<double> energy;
  if (result.energy_mj) energy = result.energy_mj->value;
  return {name,
          number(result.mean_ms(), 2),
          number(result.times.p99_ns.value * 1e-6, 2),
          number(result.times.sustainable_rate(), 1),
          result.verdict(),
          number(energy, 3),
          (result.is_whole_area ? "" : ">") + number(result.area_mm2, 2)};
}

/// Rows with a line of reasons below each but the first.
std::string table_of(const VariantResult& base, const std::vector<const VariantResult*>& rows) {
  Table table({{"", kLeft},
               {"mean ms", kRight},
               {"p99 ms", kRight, 2},
               {"fps", kRight, 3},
               {"verdict", kLeft},
               {"mJ", kRight, 1},
               {"mm2", kRight, 1}});
  table.add(cells_of(base));
  for (const VariantResult* row : rows) table.add(cells_of(*row));
  const std::string lines = terminal_text(table, std::min(table_width(), kWidth));
  std::string text;
  std::size_t begin = 0;
  constexpr std::size_t kBefore = 3;  // titles, rule, the run as it is
  for (std::size_t line = 0; begin < lines.size(); ++line) {
    const std::size_t end = lines.find('\n', begin) + 1;
    text += lines.substr(begin, end - begin);
    if (line >= kBefore) text += below(base, *rows[line - kBefore]);
    begin = end;
  }
  return text;
}

/// Time gained per area. What needs no area comes first, what needs an unknown one last; of both
/// the fastest first.
std::pair<int, double> worth(const VariantResult& base, const VariantResult& variant) {
  const Changes changes = changes_of(base, variant);
  if (!changes.area || !variant.is_whole_area) return {0, -changes.time};
  return *changes.area > 0 ? std::pair(1, -changes.time / *changes.area)
                           : std::pair(2, -changes.time);
}

std::string list_of(const std::string& title, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  return title + '\n' + wrapped(fmt::format("{}", fmt::join(items, "; ")));
}

/// In a sentence: the variant that cannot run, else the fastest.
std::string whatif_conclusion(const std::vector<VariantResult>& results) {
  const VariantResult* fastest = nullptr;
  for (std::size_t i = 1; i < results.size(); ++i) {
    if (!results[i].failure.empty()) continue;
    if (fastest == nullptr || results[i].mean_ms() < fastest->mean_ms()) fastest = &results[i];
  }
  if (fastest == nullptr) return "verdict: none of the variants can run";
  if (changes_of(results.front(), *fastest).time > -kNoChange)
    return fmt::format("in short: no variant is faster than {:.2f} ms", results.front().mean_ms());
  return fmt::format("in short: fastest is {}: {:.2f} ms instead of {:.2f}",
                     printable(fastest->name), fastest->mean_ms(), results.front().mean_ms());
}

/// A row a variant with its reason below; the first is the run as it is.
std::string whatif_table(const std::vector<VariantResult>& results) {
  std::vector<const VariantResult*> rows;
  for (std::size_t i = 1; i < results.size(); ++i) rows.push_back(&results[i]);
  return table_of(results.front(), rows);
}

/// " (+1.4 % area, +5.5 % energy)"; what is not known is left out.
std::string price_text(const Changes& changes) {
  std::vector<std::string> parts;
  if (changes.area) parts.push_back(fmt::format("{:+.1f} % area", *changes.area));
  if (changes.energy) parts.push_back(fmt::format("{:+.1f} % energy", *changes.energy));
  return parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", "));
}

/// The same ranked: time gained per area and per energy; what changes nothing, and what cannot be.
std::string advice_text(const std::vector<VariantResult>& results) {
  const VariantResult& base = results.front();
  std::vector<const VariantResult*> gains;
  std::vector<std::string> spared, same, wasted, slower, impossible;
  for (std::size_t i = 1; i < results.size(); ++i) {
    const VariantResult& result = results[i];
    if (!result.failure.empty()) {
      impossible.push_back(
          fmt::format("{} ({})", printable(result.name), printable(result.failure)));
      continue;
    }
    const Changes changes = changes_of(base, result);
    if (changes.time <= -kNoChange)
      gains.push_back(&result);
    else if (changes.time >= kNoChange)
      slower.push_back(fmt::format("{} {:+.1f} %", result.name, changes.time));
    else if (changes.area.value_or(0) < 0)
      spared.push_back(result.name + price_text(changes));
    else if (changes.area.value_or(0) > 0 || changes.energy.value_or(0) >= kNoChange)
      wasted.push_back(result.name + price_text(changes));
    else
      same.push_back(result.name);
  }
  std::stable_sort(gains.begin(), gains.end(), [&](const VariantResult* a, const VariantResult* b) {
    return worth(base, *a) > worth(base, *b);
  });
  std::string text = table_of(base, gains);
  const auto frugal = [&](const VariantResult* a, const VariantResult* b) {
    const auto of = [&](const VariantResult& r) {
      return changes_of(base, r).energy.value_or(std::numeric_limits<double>::max());
    };
    return of(*a) < of(*b);
  };
  std::vector<const VariantResult*> by_energy = gains;
  std::stable_sort(by_energy.begin(), by_energy.end(), frugal);
  std::vector<std::string> least;
  for (const VariantResult* r : by_energy)
    if (const auto energy = changes_of(base, *r).energy; energy && least.size() < 3)
      least.push_back(fmt::format("{} {:+.1f} %", r->name, *energy));
  text += list_of("\nBy time gained per area, unknown areas last. Least energy per frame:", least);
  text += list_of("Costs no time:", spared);
  text += list_of("Gains no time, but costs:", wasted);
  text += list_of("Changes nothing:", same);
  text += list_of("Takes longer:", slower);
  return text + list_of("Cannot run:", impossible);
}

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
  return {{{.title = "variant", .key = "variant", .is_setup = true}, [](R r) { return r.name; }},
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
      return {fmt::format("leviosim compare {} -p {}", shell_word(run), shell_word(change))};
  return {fmt::format("leviosim whatif {} --report whatif.html", shell_word(run))};
}

std::string WhatIfOptions::run() const {
  const bool names_run =
      !words.empty() && (is_run(words.front()) || base::is_folder(words.front()));
  return names_run ? words.front() : std::string();
}

Answer answer(const WhatIfOptions& typed, const RunnerOptions& runner, const Words& words) {
  const std::string name = typed.run();
  const std::vector<std::string> changes = typed.changes();
  SweepInputs inputs(std::filesystem::current_path(), runner.progress, trace_memory(typed.memory));
  // Refused before a flight is drawn, which takes a while.
  for (const std::string& change : changes)
    if (change.find('=') == std::string::npos) inputs.platform(change, {change});
  const Asked asked = asked_of(name, inputs, words, runner.progress);
  WhatIf what_if(inputs, asked.name, asked.again);
  std::vector<Variant> variants;
  for (const std::string& change : changes)
    for (Variant& variant : what_if.variants(change)) variants.push_back(std::move(variant));
  const bool advises = changes.empty();
  if (advises) variants = what_if.standard_variants();
  const std::vector<VariantResult> results = what_if.results(variants, runner);
  const traces::WorkTrace& trace = *inputs.trace(asked.name, {asked.name}).work;
  const std::string head = heading(asked.name, trace.info(), trace.frames());
  Answer answer{.parts = {head + (advises ? advice_text(results) : whatif_table(results))},
                .conclusion = whatif_conclusion(results),
                .next = after(name, changes),
                .rows = whatif_rows(results)};
  answer.page.title = "What if";
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

std::string reason_of(const VariantResult& base, const VariantResult& variant) {
  if (!variant.failure.empty()) return variant.failure;
  const double difference = variant.mean_ms() - base.mean_ms();
  std::vector<std::string> parts;
  if (std::abs(difference) >= kNoChange * 1e-2 * base.mean_ms())
    for (const MainCause& cause : main_causes(base.parts, variant.parts)) {
      if (parts.size() == 2 || std::abs(cause.ms) < kLeastCause * std::abs(difference)) break;
      parts.push_back(cause_text(cause));
    }
  if (std::string unused = unused_text(base.unused, variant.unused); !unused.empty())
    parts.push_back(std::move(unused));
  if (parts.empty()) return "no frame waits for it";
  return fmt::format("{}", fmt::join(parts, "; "));
}

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

Command add_whatif_command(CLI::App& app, const Words& words) {
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
