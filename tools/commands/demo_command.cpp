// leviosim demo: both profiles on the synthetic flight, and a what-if, on one screen, with pages.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "sim/base/printable.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/cli/screen.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/film/film.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/interactive/interactive_page.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/whatif/whatif.h"
#include "tools/app/study/whatif/whatif_report.h"
#include "tools/commands/commands.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {
namespace {

constexpr const char* kChip = "gap9";
constexpr const char* kReport = "report.html";

/// One profile on the flight.
struct Flown {
  std::shared_ptr<const RunResult> result;
  RunFolder folder;
  std::string trace;  ///< its work
  std::string film;   ///< where there is a page that plays it
};

Flown fly(RunOptions options, const char* profile, const Arguments& words,
          ProgressLine::Style style) {
  options.profile = profile;
  RunRequest request = make_chip_request(options);
  request.time_bands = TimeBandsOf::team;
  request.data = data_folder(options, style);
  WorkRecording recording(request.cores);
  request.recording = &recording;
  std::string pictures;
  FilmWriter film([&](std::string_view bytes) { pictures += bytes; });
  if (has_engine()) request.film = &film;
  Flown flown{
      std::make_shared<const RunResult>(simulate_with_progress(request, style)), {}, {}, {}};
  const Manifest manifest = make_manifest(options, request, words);
  flown.folder = run_folder(options.out + '/' + profile, flown.result, manifest,
                            platform::to_yaml(request.platform));
  flown.trace = work_trace_of(std::move(recording), options, request, manifest);
  if (has_engine()) flown.film = std::move(pictures);
  return flown;
}

/// "levio.html", which computes and plays the flight.
std::string page_name(const Flown& flown) { return flown.result->profile + ".html"; }

std::string page_of(const Flown& flown) {
  const std::string& name = flown.folder.record.name;
  const traces::WorkTrace trace(name, flown.trace);
  return interactive_page({name, trace, flown.folder, flown.result->trajectory,
                           film_of(name, flown.film, traces::kTraceMemory)});
}

/// Milliseconds of a call on one core and on all, and their ratio.
std::string stage_cells(const RunResult& run, std::string_view name) {
  const auto stage = std::find_if(run.stages.begin(), run.stages.end(),
                                  [&](const StageResult& s) { return s.name == name; });
  if (stage == run.stages.end() || stage->calls == 0)
    return fmt::format("{:>9}{:>9}{:>8}", "–", "–", "–");
  const Hertz clock = clock_of(run, *stage);
  return fmt::format("{:9.2f}{:9.2f}{:7.2f}×",
                     milliseconds(*mean(stage->single, stage->calls), clock),
                     milliseconds(*mean(stage->parallel, stage->calls), clock), *speedup(*stage));
}

/// The stages on which the two together spend most, in the order of the first.
std::vector<std::string_view> longest_stages(const RunResult& a, const RunResult& b) {
  constexpr std::size_t kRows = 6;
  struct Sum {
    std::string_view name;
    Cycles cycles;
  };
  std::vector<Sum> sums;
  for (const RunResult* run : {&a, &b})
    for (const StageResult& stage : run->stages) {
      const auto known = std::find_if(sums.begin(), sums.end(),
                                      [&](const Sum& s) { return s.name == stage.name; });
      if (known == sums.end())
        sums.push_back({stage.name, stage.parallel});
      else
        known->cycles += stage.parallel;
    }
  std::vector<Sum> order = sums;
  std::stable_sort(order.begin(), order.end(),
                   [](const Sum& x, const Sum& y) { return x.cycles > y.cycles; });
  order.resize(std::min(order.size(), kRows));
  std::vector<std::string_view> names;
  for (const Sum& sum : sums)
    if (std::any_of(order.begin(), order.end(), [&](const Sum& s) { return s.name == sum.name; }))
      names.push_back(sum.name);
  return names;
}

std::string row(std::string_view name, const std::string& levio, const std::string& next) {
  return fmt::format("{:<22}{:>27}{:>30}\n", name, levio, next);
}

std::string worst_frame(const RunResult& run) {
  const auto late = std::count_if(run.frames.begin(), run.frames.end(),
                                  [&](const FrameResult& f) { return is_late(f, run); });
  return fmt::format("{:.1f} ms, {} of {} late",
                     static_cast<double>(latencies_of(run).max_ns) * 1e-6, late, run.frames.size());
}

std::string memory(const RunResult& run) {
  Bytes l1, l2;
  for (const StageResult& stage : run.stages)
    if (!stage.on_controller) l1 = std::max(l1, stage.memory.parallel);
  for (const L2Row& part : run.l2) l2 += part.bytes;
  const auto kilo = [](Bytes b) { return static_cast<double>(b.count()) * 1e-3; };
  return fmt::format("{:.0f} and {:.0f} kB", kilo(l1), kilo(l2));
}

std::string energy(const RunResult& run) {
  const std::optional<RunEnergy> of_run = energy_of(run);
  if (!of_run || !of_run->per_frame() || !of_run->mean_power()) return "–";
  return fmt::format("{:.2f} mJ, {:.1f} mW", of_run->per_frame()->value.count() * 1e3,
                     of_run->mean_power()->value.count() * 1e3);
}

std::string error(const RunResult& run) {
  return run.ate ? fmt::format("{} of {:.1f} m", metres_text(run.ate->translation.rmse, 2),
                               run.ate->path_length_m)
                 : "–";
}

/// What is asked, and its name on the screen.
struct Question {
  const char* name;
  const char* change;
};
constexpr std::array<Question, 3> kQuestions{
    {{"one FPU", "cluster.fpu.units=1"},
     {"16 KiB shared I-cache", "cluster.icache.shared_size=16KiB"},
     {"240 MHz at 0.65 V", "cluster.clock=240MHz,controller.clock=240MHz,supply.voltage=0.65V"}}};

/// The recorded work on other chips: a frame's front end, and what it takes.
std::string what_ifs(const std::string& trace, ProgressLine::Style style) {
  const std::string run = "levio/work.trace";
  SweepInputs inputs(std::filesystem::current_path(), style);
  inputs.keep_trace(run, trace);
  WhatIf what_if(inputs, run, {});
  std::vector<Variant> variants;
  for (const Question& question : kQuestions)
    for (Variant& variant : what_if.variants(question.change)) {
      variant.name = question.name;
      variants.push_back(std::move(variant));
    }
  return whatif_bars(what_if.results(variants, {.noun = "variant", .progress = style}));
}

/// "levio takes 37.1 ms and 1.53 mJ".
std::string frame_of(const RunResult& run) {
  const std::optional<FrameTimes> times = frame_times(run);
  const std::optional<RunEnergy> of_run = energy_of(run);
  std::string text =
      fmt::format("{} takes {:.1f} ms", run.profile, times ? times->mean_ns.value * 1e-6 : 0.0);
  if (of_run && of_run->per_frame())
    text += fmt::format(" and {:.2f} mJ", of_run->per_frame()->value.count() * 1e3);
  return text;
}

/// What works, in a sentence.
std::string demo_verdict(const RunResult& a, const RunResult& b) {
  const auto late = [](const RunResult& run) {
    return std::count_if(run.frames.begin(), run.frames.end(),
                         [&](const FrameResult& f) { return is_late(f, run); });
  };
  const auto number = late(a) + late(b);
  const std::string late_text = number == 0 ? std::string("none is late")
                                            : fmt::format("{} of {} frames are late", number,
                                                          a.frames.size() + b.frames.size());
  return wrap_words(fmt::format("verdict: {}: {} a frame on {} cores, {}; {}",
                                number == 0 ? "fits" : "fits on average", frame_of(a), a.cores,
                                frame_of(b), late_text),
                    2, kScreenColumns) +
         '\n';
}

std::string screen(const Flown& levio, const Flown& next, const std::string& what_ifs,
                   const RunOptions& options, const std::string& out) {
  const RunResult &a = *levio.result, &b = *next.result;
  std::string text = demo_verdict(a, b);
  text += fmt::format("{} {}frames on GAP9: ms of a call on one core and on {}\n", a.frames.size(),
                      options.data == "synthetic" ? "drawn " : "", a.cores);
  text += fmt::format("{:<22}{:>9}{:>8}{:>9}    {:>9}{:>8}{:>9}\n", "", "levio: 1", a.cores,
                      "speed-up", "next: 1", b.cores, "speed-up");
  for (const std::string_view stage : longest_stages(a, b))
    text += fmt::format("{:<22}{}    {}\n", stage, stage_cells(a, stage), stage_cells(b, stage));
  text += row(fmt::format("worst of {:.4g} ms", static_cast<double>(a.frame_period_ns) * 1e-6),
              worst_frame(a), worst_frame(b));
  text += row("L1 and L2", memory(a), memory(b));
  text += row("a frame, mean power", energy(a), energy(b));
  text += row("error (SE3-aligned)", error(a), error(b));
  if (options.data == "synthetic" && options.frames.empty())
    text += "levio's scale drifts on this flight, as the released program's (0.7-0.8 m)\n";
  text += fmt::format("{:<22}{:>9} {:>7}\n", "what if, levio", "front end", "a frame") + what_ifs;
  const std::string folder = printable(std::filesystem::absolute(out).lexically_normal().string());
  text += fmt::format("Both runs as a page: file://{}/{}\n", folder, kReport);
  text += has_engine()
              ? fmt::format("Beside it, with sliders, and played: {} and {}\n", page_name(levio),
                            page_name(next))
              : "With sliders: tools/setup.sh pages; LEVIOSIM_WASM=ON tools/build.sh release\n";
  return text + fmt::format(
                    "next: leviosim whatif {0}/levio\n"
                    "      leviosim why {0}/levio\n",
                    printable(out));
}

void run(RunOptions options, const Arguments& words) {
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  outputs::OutputFolder out(out_request(options));
  const Flown levio = fly(options, "levio", words, style);
  const Flown next = fly(options, "next", words, style);
  const std::string text = screen(levio, next, what_ifs(levio.trace, style), options, options.out);
  const Allowed allowed = parse_allowed("profile");
  const std::string page = html_page(runs_report(
      {levio.folder, next.folder},
      {compare_runs(levio.folder.record, next.folder.record,
                    check_comparable(levio.folder.record, next.folder.record, allowed))},
      nullptr));
  publish(out, Printout(text), [&] {
    for (const Flown* flown : {&levio, &next}) {
      const std::string below = flown->result->profile + '/';
      write_run_folder(out, flown->folder, below);
      out.write(below + kWorkTraceFile, flown->trace);
      if (!has_engine()) continue;
      out.write(below + kFilmFile, flown->film);
      out.write(page_name(*flown), page_of(*flown));
    }
    out.write(kReport, page);
  });
}

}  // namespace

Command add_demo_command(CLI::App& app, const Arguments& words) {
  CLI::App* command = app.add_subcommand(
      "demo", "Both profiles on the synthetic flight and a what-if, on a screen");
  const auto options = std::make_shared<RunOptions>();
  options->platform = kChip;
  options->data = "synthetic";
  options->out = "leviosim-demo";
  const TextOptions add{*command};
  add("--data", options->data, "DIR|synthetic", "another flight: an ASL/EuRoC folder [synthetic]");
  add("--frames", options->frames, "A:B", "frames, B exclusive [all]");
  command->add_flag("--quiet", options->quiet, "no progress");
  add_out_options(*command, *options);
  command->get_option("--out")->description("folder for both runs and the report [leviosim-demo]");
  add_examples(*command, {"leviosim demo --data flight --out both"});
  return {command, [=, &words] { run(*options, words); }};
}

}  // namespace leviosim::tools
