#include "tools/app/timeline/requested_timeline.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/chip/chip.h"
#include "sim/outputs/file_system.h"
#include "sim/soc/run_account.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

constexpr int kFramesOfPicture = 2;  // as many as a picture of usual width shows

std::optional<traces::FrameRange> range_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    return traces::parse_frame_range(text);
  } catch (const InputError& error) {
    throw InputError(fmt::format("--timeline-frames: {}", error.what()));
  }
}

/// A folder of results appears as a whole; a file in it would be lost or in its way.
void refuse_within(const outputs::OutputRequest& results, const std::string& file) {
  std::error_code error;
  const std::filesystem::path folder = outputs::resolved(results.path, error);
  const std::filesystem::path path = outputs::resolved(file, error);
  if (*path.lexically_relative(folder).begin() != "..")
    throw InputError(
        fmt::format("--timeline {}: lies in the folder of {}; choose a place beside it", file,
                    results.shown()));
}

/// What opens such files would not open this one.
void refuse_other_formats(const std::string& file) {
  const std::filesystem::path extension = std::filesystem::path(file).extension();
  for (const char* other : {".json", ".html", ".htm", ".csv", ".png", ".pdf"})
    if (extension == other)
      throw InputError(fmt::format(
          "--timeline {}: expected a name that ends in .svg, a picture, or in .pftrace, for "
          "ui.perfetto.dev",
          file));
}

outputs::OutputRequest file_request(const std::string& file,
                                    const outputs::OutputRequest& results) {
  refuse_other_formats(file);
  refuse_within(results, file);
  return {
      .option = "--timeline", .path = file, .replace = results.replace, .inputs = results.inputs};
}

StepKind kind_of(const work::Step& step) {
  if (std::holds_alternative<work::Serial>(step)) return StepKind::Serial;
  if (std::holds_alternative<work::Fork>(step)) return StepKind::Fork;
  if (std::holds_alternative<work::Transfer>(step)) return StepKind::Transfer;
  return StepKind::Wait;
}

/// Absent where the energy is not known.
std::optional<Watts> power_in(const std::optional<RunEnergy>& energy, std::string_view stage) {
  if (!energy) return std::nullopt;
  const auto row = std::find_if(energy->rows.begin(), energy->rows.end(),
                                [&](const EnergyRow& r) { return r.name == stage; });
  if (row == energy->rows.end()) return std::nullopt;
  const std::optional<sim::Estimate<Watts>> power = row->power();
  return power ? std::optional(power->value) : std::nullopt;
}

}  // namespace

void add_timeline_options(CLI::App& command, TimelineOptions& options) {
  const TextOptions add{command};
  add("--timeline", options.file, "FILE",
      "when everything happened: for ui.perfetto.dev, which opens the file locally, if the "
      "name ends in .pftrace; as a picture if it ends in .svg");
  add("--timeline-frames", options.frames, "A:B",
      "frames of the timeline as frames.csv numbers them, B exclusive [all; of a "
      "picture two in the middle]");
}

RequestedTimeline::RequestedTimeline(const TimelineOptions& options,
                                     const outputs::OutputRequest& results,
                                     const RunRequest& request)
    : name_(options.file),
      is_picture_(std::filesystem::path(name_).extension() == ".svg"),
      chosen_(is_picture_ && options.frames.empty()),
      collector_(request.platform.config, request.cores, range_of(options.frames),
                 chosen_ ? kFramesOfPicture : 0),
      file_(claimed_file(file_request(options.file, results))) {}

void RequestedTimeline::publish(const RunResult& run, bool prints_name) {
  std::string label = "timeline";
  if (chosen_ && collector_.events().range)
    label += fmt::format(" of frames {}:{} (--timeline-frames A:B for others)",
                         collector_.events().range->begin, collector_.events().range->end);
  tools::publish({{file_,
                   is_picture_ ? timeline_picture(collector_.events(), run)
                               : perfetto_timeline(collector_.events(), run),
                   label}},
                 Printout("", !prints_name));
}

std::optional<RequestedTimeline> requested_timeline(const TimelineOptions& options,
                                                    const outputs::OutputRequest& results,
                                                    const RunRequest& request) {
  if (options.file.empty()) {
    if (!options.frames.empty())
      throw InputError("--timeline-frames is for a timeline; expected --timeline as well");
    return std::nullopt;
  }
  if (request.native)
    throw InputError("run: --native computes without a chip; leave out --timeline");
  return std::optional<RequestedTimeline>(std::in_place, options, results, request);
}

TimelineCollector::TimelineCollector(const sim::ChipConfig& chip, int cores,
                                     std::optional<traces::FrameRange> range, int middle)
    : middle_(middle), events_{sim::timebase_of(chip), cores, range, {}, {}} {
  job_run_.chip = chip;
  job_run_.cores = cores;
}

void TimelineCollector::on_start(int frames) {
  if (middle_ > 0 && frames > middle_) {
    const auto begin = static_cast<std::size_t>((frames - middle_) / 2);
    events_.range = traces::FrameRange{begin, begin + static_cast<std::size_t>(middle_)};
  }
  if (events_.range)
    traces::check_frame_range(*events_.range, static_cast<std::size_t>(frames),
                              "--timeline-frames: the run");
}

void TimelineCollector::on_front_end(const FrontEndJob& job) {
  if (!events_.holds(job.frame)) return;
  FrameEvents& frame = events_.frames.emplace_back();
  frame.frame = job.frame;
  frame.result = job.result;
  frame.optimisation_begun = job.optimisation_begun;
  frame.work_begin =
      job.parallel.stages.empty() ? job.parallel.begin : job.parallel.stages.front().begin;
  frame.stages = stages_of(job.job, job.parallel, false);
}

void TimelineCollector::on_optimiser(const OptimiserJob& job) {
  if (!events_.holds(job.frame)) return;
  events_.iterations.push_back({job.frame, job.iteration, job.last, job.timing.begin,
                                job.timing.end, stages_of(job.job, job.timing, true)});
}

std::vector<StageEvents> TimelineCollector::stages_of(const work::Job& job,
                                                      const sim::JobTiming& timing,
                                                      bool on_controller) {
  std::vector<StageResult> names;
  for (const work::StageRun& run : job.stages) {
    StageResult& stage = names.emplace_back();
    stage.name = run.stage;
    stage.on_controller = on_controller;
  }
  soc::RunAccount account(std::move(names), job_run_.chip);
  account.add_work(job);
  account.add_parallel(timing);
  job_run_.stages = account.stages();
  const std::optional<RunEnergy> energy = energy_of(job_run_);

  check_equal(job.stages.size(), timing.stages.size(), "stages of a job that were timed");
  std::vector<StageEvents> stages;
  for (std::size_t i = 0; i < job.stages.size(); ++i) {
    const sim::StageTiming& timed = timing.stages[i];
    StageEvents& stage = stages.emplace_back(StageEvents{
        timed.stage, timed.begin, timed.end, timed.cycles, job.stages[i].memory.parallel});
    stage.power = power_in(energy, timed.stage);
    for (const sim::StepTiming& step : timed.steps) stage.steps.push_back(step_of(step));
  }
  return stages;
}

StepEvents TimelineCollector::step_of(const sim::StepTiming& timing) const {
  const auto cycles = [&](sim::Time begin, sim::Time end) {
    return events_.timebase.clock("cluster").whole_cycles(end - begin);
  };
  StepEvents step;
  step.kind = kind_of(*timing.step);
  step.begin = timing.begin;
  step.end = timing.end;
  step.cycles = cycles(timing.begin, timing.end);
  step.synchronisation = timing.synchronisation;
  if (step.kind == StepKind::Serial) step.serial = step.cycles;
  if (step.kind == StepKind::Transfer || step.kind == StepKind::Wait) step.transfer = step.cycles;
  if (const auto* fork = std::get_if<work::Fork>(timing.step)) step.name = fork->name;
  if (const auto* transfer = std::get_if<work::Transfer>(timing.step))
    step.transfers.push_back(
        {transfer->direction, timing.data.begin, timing.data.end, transfer->bytes});
  for (const sim::CoreTiming& core : timing.cores) {
    const bool is_master = core.core == events_.cores;
    step.cores.push_back({core.core, core.begin, core.end, cycles(core.begin, core.end),
                          is_master ? Cycles(0) : cycles(core.end, timing.end), core.time});
  }
  std::sort(step.cores.begin(), step.cores.end(),
            [](const CoreEvents& a, const CoreEvents& b) { return a.core < b.core; });
  return step;
}

}  // namespace leviosim::tools
