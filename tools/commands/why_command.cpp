// `leviosim why`: why a frame of a recorded run was late, or took as long as it did.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/record.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/record_source.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_session.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/why/late_frame.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct WhyOptions : RunOptions {
  std::string run;
  std::string frame;
  std::string memory;
};

/// Of the user, or the slowest.
int asked_frame(const WhyOptions& options, const std::vector<FrameResult>& frames) {
  if (options.frame.empty()) return slowest_frame(frames);
  return static_cast<int>(parse_whole("FRAME", options.frame, 0,
                                      static_cast<std::int64_t>(frames.size()) - 1,
                                      ", the number of the last frame"));
}

std::string stage_table(const ExplainedFrame& median, const ExplainedFrame& frame) {
  Table table({{"stage", kLeft},
               {fmt::format("frame {}", median.number)},
               {fmt::format("frame {}", frame.number)},
               {"change, ms"},
               {"most of it", kLeft}});
  constexpr double kShown_ms = 0.005;  // else it is printed as 0.00
  for (const StageDifference& d : stage_differences(median, frame)) {
    const bool is_shown = std::abs(d.cause_ms) >= kShown_ms;
    table.add({d.stage, fmt::format("{:.2f}", d.median_ms), fmt::format("{:.2f}", d.ms),
               fmt::format("{:+.2f}", d.change_ms()),
               is_shown ? fmt::format("{:+.2f} {}", d.cause_ms, d.cause) : ""});
  }
  return terminal_text(table);
}

std::string fact_lines(const ExplainedFrame& median, const ExplainedFrame& frame) {
  std::vector<std::string> facts;
  for (const FactDifference& d : fact_differences(median, frame))
    facts.push_back(fmt::format("{}: {} → {}", d.fact, d.median, d.frame));
  if (facts.empty()) return "the front end saw the same in both, within a tenth\n";
  return wrap(facts, "; ", 2, output_width()) + "\n";
}

Json answer_json(const ExplainedFrame& median, const ExplainedFrame& frame, double period_ms) {
  const auto of_frame = [](const ExplainedFrame& f) {
    return Json{{"frame", f.number},
                {"waited_ms", f.waited_ms},
                {"own_ms", f.own_ms},
                {"latency_ms", f.latency_ms()}};
  };
  Json stages = Json::array();
  for (const StageDifference& d : stage_differences(median, frame))
    stages.push_back({{"stage", d.stage},
                      {"median_ms", d.median_ms},
                      {"ms", d.ms},
                      {"cause", d.cause},
                      {"cause_ms", d.cause_ms}});
  Json facts = Json::array();
  for (const FactDifference& d : fact_differences(median, frame))
    facts.push_back({{"fact", d.fact}, {"median", d.median}, {"frame", d.frame}});
  return {{"answer", why_text(median, frame, period_ms)},
          {"period_ms", period_ms},
          {"median", of_frame(median)},
          {"frame", of_frame(frame)},
          {"stages", std::move(stages)},
          {"facts", std::move(facts)}};
}

void run(const CLI::App& command, const WhyOptions& options) {
  require(command, "RUN", "the folder of a run with --record, or a work trace");
  const std::string file = trace_of(options.run);
  if (file.empty())
    throw InputError(
        fmt::format("{}: holds no {}; expected the folder of a run with --record, or a work trace",
                    options.run, kWorkTraceFile));
  const traces::WorkTrace trace(file, trace_memory(options.memory));
  RunRequest request = replay_request(trace, options);
  request.on_one_core = false;
  ProgressLine line(ProgressLine::style_of_stderr(options.quiet));
  const RunResult times = replay(trace, request, shown_on(line)).run;
  if (times.frames.empty()) throw InputError(fmt::format("{}: holds no frames", file));
  const int number = asked_frame(options, times.frames);
  FrameWatcher watcher(request.platform.config, request.cores, number, median_frame(times.frames));
  request.observer = &watcher;
  replay(trace, request, shown_on(line));
  line.clear();
  const ExplainedFrame& frame = watcher.frame();
  const ExplainedFrame& median = watcher.other();
  const double period_ms = static_cast<double>(times.frame_period_ns) * 1e-6;
  print(printout(
      options.json,
      [&] {
        const std::string head =
            fmt::format("{}: {}, {} frames of {}, on {}, {} cores\n", printable(options.run),
                        printable(times.profile), times.frames.size(), printable(trace.info().data),
                        printable(times.chip.name), times.cores);
        return Printout({head + stage_table(median, frame), fact_lines(median, frame),
                         frame_bars(median, frame, period_ms, std::min(output_width(), 100))})
            .ending("in short: " + why_text(median, frame, period_ms),
                    {fmt::format("leviosim replay {} --timeline frame.svg --timeline-frames "
                                 "{}:{} --out late",
                                 shell_word(options.run), number, number + 1)});
      },
      [&] { return answer_json(median, frame, period_ms).dump(2) + "\n"; }));
}

}  // namespace

Command add_why_command(CLI::App& app, const Arguments&) {
  CLI::App* command = app.add_subcommand("why", "Why a frame was late, beside the median frame");
  const auto options = std::make_shared<WhyOptions>();
  command->add_option("RUN", options->run, "folder of a run with --record, or a work trace");
  command->add_option("FRAME", options->frame, "number of the frame, from 0 [the slowest]");
  add_chip_options(*command, *options, " [that of the recording]");
  add_memory_option(*command, options->memory);
  command->add_flag("--quiet", options->quiet, "no progress");
  add_json_option(*command, options->json);
  add_examples(*command, {"leviosim why recorded", "leviosim why recorded 8"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
