#include "traces/work_traces/work_frames.h"

#include <fmt/core.h>

#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "traces/work_traces/memory_budget.h"
#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_memory.h"

namespace leviosim::traces {
namespace {

constexpr std::uint64_t kMostNumber = std::uint64_t{1} << 31;

}  // namespace

WorkFrames::WorkFrames(const WorkTrace& trace, bool offload, std::optional<work::CompiledFor> code)
    : trace_(&trace),
      with_offload_(offload),
      code_(code),
      budget_(trace.budget()),
      stage_names_(trace.names().size()) {}

bool WorkFrames::next(WorkFrame& frame) {
  throw_if_interrupted();
  if (frames_left_ == 0) {
    if (next_chunk_ == trace_->chunks().size()) return false;
    open_chunk(frame);
  }
  if (budget_.used() - of_chunk_ > budget_.ceiling() / 8) drop_storage(frame);
  const std::uint64_t before = budget_.used();
  read_facts(frame);
  read_job(frame.front_end, false);
  read_iterations(frame);
  add_decoded(kDecodedPerFrame + budget_.used() - before);
  ++frame_;
  if (--frames_left_ == 0) close_chunk();
  return true;
}

void WorkFrames::skip_to(int frame) {
  const std::vector<WorkTrace::Chunk>& chunks = trace_->chunks();
  while (next_chunk_ + 1 < chunks.size() && chunks[next_chunk_ + 1].first <= frame) ++next_chunk_;
  if (next_chunk_ < chunks.size()) frame_ = chunks[next_chunk_].first;
  WorkFrame before;
  while (frame_ < frame && next(before)) {
  }
}

void WorkFrames::read_iterations(WorkFrame& frame) {
  const std::uint64_t before = budget_.used();
  frame.iterations.resize(frame.optimised ? text_.count("iterations of the optimiser", kJobMemory)
                                          : 0);
  for (work::Job& job : frame.iterations) read_job(job, true);
  // A replay keeps them until the next optimisation begins, beside those of later frames.
  text_.charge(1, budget_.used() - before, "iterations that are kept");
}

/// Storage of a frame is used again by the next, and grows by that: after some, it begins anew.
void WorkFrames::drop_storage(WorkFrame& frame) {
  frame.front_end = {};
  frame.iterations = std::vector<work::Job>();  // unlike {}, gives the memory back
  budget_.release_to(of_chunk_);
}

void WorkFrames::add_decoded(std::uint64_t bytes) {
  decoded_ += bytes;
  const std::uint64_t most = budget_.ceiling() + kDecodedPerByte * trace_->file_size();
  if (decoded_ > most) [[unlikely]]
    text_.fail(
        fmt::format("what is read up to here stands for {}, which takes long; from a file of {} "
                    "expected {} at most: --max-memory SIZE allows more",
                    memory_text(decoded_), memory_text(trace_->file_size()), memory_text(most)));
}

void WorkFrames::open_chunk(WorkFrame& frame) {
  of_chunk_ = trace_->budget().used();
  drop_storage(frame);
  for (std::string* content : {&content_, &offload_content_}) std::string().swap(*content);
  const WorkTrace::Chunk& chunk = trace_->chunks()[next_chunk_++];
  place_ = fmt::format("{}, frames {} to {} (section at byte {})", trace_->name(), chunk.first,
                       chunk.first + chunk.frames - 1, chunk.section.offset);
  content_ = unpacked(chunk.section, trace_->name(), budget_);
  text_ = ByteReader(content_, place_, &budget_);
  frames_left_ = chunk.frames;
  const std::uint64_t frames = text_.whole("the number of frames");
  if (frames != static_cast<std::uint64_t>(chunk.frames))
    text_.fail(fmt::format("holds {} frames; expected {}", frames, chunk.frames));
  open_series(text_, series_);
  peaks_ = std::vector<work::MemoryPeak>();
  if (with_offload_) open_offload(chunk);
  add_decoded(budget_.used() - of_chunk_);
  of_chunk_ = budget_.used();
}

void WorkFrames::open_offload(const WorkTrace::Chunk& chunk) {
  offload_place_ =
      fmt::format("{}, offload regions of frames {} to {} (section at byte {})", trace_->name(),
                  chunk.first, chunk.first + chunk.frames - 1, chunk.offload.offset);
  offload_content_ = unpacked(chunk.offload, trace_->name(), budget_);
  offload_text_ = ByteReader(offload_content_, offload_place_, &budget_);
  open_series(offload_text_, offload_series_);
}

void WorkFrames::open_series(ByteReader& in, std::vector<SeriesReader>& series) {
  const std::string& place = in.place();
  ByteReader heads(in.take(in.count("bytes of series", 0), "series"), place, &budget_);
  ByteReader columns(in.take(in.count("bytes of columns", 0), "columns"), place, &budget_);
  series = std::vector<SeriesReader>();
  const std::size_t number = heads.count("series", sizeof(SeriesReader));
  series.reserve(number);
  for (std::size_t i = 0; i < number; ++i)
    series.emplace_back(heads, columns, trace_->fields(), code_);
  heads.expect_end();
  columns.expect_end();
}

void WorkFrames::close_chunk() {
  text_.expect_end();
  for (SeriesReader& series : series_) series.expect_end();
  if (!with_offload_) return;
  offload_text_.expect_end();
  for (SeriesReader& series : offload_series_) series.expect_end();
}

std::string_view WorkFrames::read_name() {
  return trace_->names()[text_.whole_below(trace_->names().size(), "the number of a name")];
}

void WorkFrames::read_facts(WorkFrame& frame) {
  const auto number = [&](const char* what) {
    return static_cast<int>(text_.whole_below(kMostNumber, what));
  };
  frame.index = number("the number of a frame in its data set");
  frame.t_ns = trace_->info().stamps_ns[static_cast<std::size_t>(frame_)];
  frame.source = read_name();
  const std::uint64_t flags = text_.whole_below(kAllFlags + 1, "flags of a frame");
  frame.keyframe = (flags & kKeyframe) != 0;
  frame.optimiser_busy = (flags & kBusy) != 0;
  frame.optimised = (flags & kOptimised) != 0;
  if (frame.optimiser_busy && frame.optimised)
    text_.fail("a frame begins an optimisation while the optimiser is busy");
  frame.facts.resize(trace_->info().facts.size());
  for (int& fact : frame.facts) fact = number("a fact of a frame");
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      frame.T_world_body(row, column) = text_.f64("a number of a pose");
  frame.start_ns = static_cast<std::int64_t>(text_.whole_below(std::uint64_t{1} << 62, "a time"));
  const std::int64_t seen = text_.integer("the frame of the optimiser's newest result");
  if (seen < -1 || seen >= frame_)
    text_.fail(
        fmt::format("the optimiser's newest result is of frame {}; expected an earlier one "
                    "than {}, or -1",
                    seen, frame_));
  frame.seen = static_cast<int>(seen);
}

void WorkFrames::read_job(work::Job& job, bool on_controller) {
  background_ = waits_ = 0;
  job.stages.resize(text_.count("stages of a job", kStageMemory));
  for (work::StageRun& stage : job.stages) read_stage(stage, on_controller);
  if (waits_ != background_)
    text_.fail(
        fmt::format("a job waits {} times for {} background transfers", waits_, background_));
}

/// There are few: what is reported has a part for each.
std::string_view WorkFrames::read_stage_name() {
  const std::size_t number = text_.whole_below(trace_->names().size(), "the number of a name");
  if (!stage_names_[number]) {
    stage_names_[number] = true;
    if (++stages_ > kMostStages)
      text_.fail(fmt::format("more than {} stages have different names", kMostStages));
  }
  return trace_->names()[number];
}

void WorkFrames::read_stage(work::StageRun& stage, bool on_controller) {
  stage.stage = read_stage_name();
  read_peak(stage.memory);
  stage.steps.resize(text_.count("steps of a stage", kStepMemory));
  for (work::Step& step : stage.steps) read_step(step, on_controller);
}

void WorkFrames::read_step(work::Step& step, bool on_controller) {
  const std::uint64_t kind = text_.whole_below(kStepKinds, "the kind of a step");
  switch (kind) {
    case kSerial: {
      auto* serial = std::get_if<work::Serial>(&step);
      if (serial == nullptr) serial = &step.emplace<work::Serial>();
      read_counts(text_.whole("a series"), serial->counts);
      return;
    }
    case kFork:
    case kForkWithMaster:
    case kForkAlignedOnOneCore: {
      auto* fork = std::get_if<work::Fork>(&step);
      if (fork == nullptr) fork = &step.emplace<work::Fork>();
      fork->master_takes_part = kind == kForkWithMaster;
      fork->aligned_on_one_core = kind == kForkAlignedOnOneCore;
      read_fork(*fork, on_controller);
      return;
    }
    case kTransfer:
    case kBackgroundTransfer:
      step.emplace<work::Transfer>(read_transfer(kind == kBackgroundTransfer, on_controller));
      return;
    default:
      step.emplace<work::TransferWait>(read_wait());
  }
}

work::Transfer WorkFrames::read_transfer(bool background, bool on_controller) {
  const auto direction =
      static_cast<work::Direction>(text_.whole_below(kDirections, "the direction of a transfer"));
  if (!on_controller && !work::is_between_l1_and_l2(direction))
    text_.fail("a transfer of the cluster from or to external memory, which it cannot reach");
  const Bytes bytes(
      static_cast<std::int64_t>(text_.whole_below(kMostTransferred, "bytes of a transfer")));
  if (!background) return {direction, bytes};
  ++background_;
  const auto most = static_cast<std::uint64_t>(bytes.count()) + 1;
  const Bytes more(static_cast<std::int64_t>(
      text_.whole_below(most, "bytes of a transfer that a larger memory would not need")));
  return {direction, bytes, true, more};
}

work::TransferWait WorkFrames::read_wait() {
  ++waits_;
  return {static_cast<std::int32_t>(text_.whole_below(static_cast<std::uint64_t>(background_),
                                                      "the number of a background transfer"))};
}

void WorkFrames::read_fork(work::Fork& fork, bool on_controller) {
  fork.name = read_name();
  const auto workers = static_cast<std::size_t>(on_controller ? 1 : trace_->info().cores);
  const std::size_t shares = workers + (fork.master_takes_part ? 1 : 0);
  text_.charge(shares, sizeof(work::Segment), "shares of a fork");
  fork.shares.resize(shares);
  const std::uint64_t series = text_.whole("a series");
  for (std::size_t k = 0; k < workers; ++k) read_counts(series, fork.shares[k]);
  if (fork.master_takes_part) read_counts(text_.whole("a series"), fork.shares.back());
}

void WorkFrames::read_peak(work::MemoryPeak& peak) {
  const std::uint64_t number = text_.whole_below(peaks_.size() + 1, "the number of a memory peak");
  if (number > 0) {
    const work::MemoryPeak& same = peaks_[number - 1];
    text_.charge(same.blocks.size(), kBlockMemory, "blocks of memory");
    peak = same;
    return;
  }
  const auto bytes = [&] {
    return Bytes(static_cast<std::int64_t>(text_.whole_below(kMostBytes, "bytes of memory")));
  };
  peak.parallel = bytes();
  peak.single = bytes();
  peak.blocks.resize(text_.count("blocks of memory", kBlockMemory));
  for (work::Block& block : peak.blocks) {
    block.name = read_name();
    block.offset = bytes();
    block.size = bytes();
  }
  const std::size_t kept = sizeof(work::MemoryPeak) + peak.blocks.size() * sizeof(work::Block);
  text_.charge(1, kept, "a memory peak");
  of_chunk_ += kept;
  peaks_.push_back(peak);
}

void WorkFrames::read_counts(std::uint64_t series, work::Segment& segment) {
  if (series >= series_.size()) [[unlikely]]
    text_.fail(fmt::format("a work segment is of series {}; there are {}", series, series_.size()));
  series_[series].next(segment);
  add_decoded(series_[series].size());
  if (with_offload_) read_offload(segment);
}

void WorkFrames::read_offload(work::Segment& segment) {
  const std::size_t kinds =
      offload_text_.whole_below(work::kOffloadKindCount + 1, "the number of offload regions");
  offload_text_.charge(kinds, sizeof(work::OffloadWork), "offload regions");
  segment.offload.resize(kinds);
  work::Counts left = segment;  // that is not yet part of a call
  std::size_t least = 0;        // each kind at most once, in their order
  for (work::OffloadWork& calls : segment.offload) {
    const std::string& name =
        trace_->names()[offload_text_.whole_below(trace_->names().size(), "the number of a name")];
    while (least < work::kOffloadKindCount && work::kOffloadKinds[least].name != name) ++least;
    if (least == work::kOffloadKindCount)
      offload_text_.fail(
          fmt::format("'{}' is no kernel that is known, or comes twice in a work segment", name));
    calls.kernel = work::kOffloadKinds[least++].kernel;
    calls.calls =
        offload_text_.whole_below(std::uint64_t{1} << kCounterBits, "offload regions of a kind");
    calls.items = offload_text_.whole_below(std::uint64_t{1} << kCounterBits, "items of a kernel");
    const std::uint64_t series =
        offload_text_.whole_below(offload_series_.size(), "a series of offload regions");
    offload_series_[series].next(calls.counts);
    add_decoded(offload_series_[series].size());
    for (std::size_t i = 0; i < work::kOpCount; ++i) {
      if (calls.counts.n[i] > left.n[i])
        offload_text_.fail("offload regions count more than their work segment");
      left.n[i] -= calls.counts.n[i];
    }
  }
}

}  // namespace leviosim::traces
