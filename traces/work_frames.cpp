#include "traces/work_frames.h"

#include <fmt/core.h>

#include <utility>

#include "sim/base/interruption.h"
#include "sim/check.h"
#include "sim/error.h"

namespace leviosim::traces {
namespace {

enum : std::uint64_t { kSerial, kFork, kForkWithMaster, kTransfer, kBackgroundTransfer, kWait };
constexpr std::uint64_t kStepKinds = kWait + 1;
constexpr std::uint64_t kDirections = 4;
constexpr std::uint64_t kKeyframe = 1, kBusy = 2, kOptimised = 4, kAllFlags = 7;
/// No memory of such chips comes near.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;
constexpr std::uint64_t kMostNumber = std::uint64_t{1} << 31;

/// What stands before a piece of serial work, which tells it from others of its stage.
std::string_view label_of(const work::Step& step) {
  if (const auto* fork = std::get_if<work::Fork>(&step)) return fork->name;
  return std::holds_alternative<work::Serial>(step) ? "serial" : "transfer";
}

}  // namespace

std::uint64_t NameTable::number_of(std::string_view name) {
  const auto found = numbers_.find(name);
  if (found != numbers_.end()) return found->second;
  numbers_.emplace(name, names_.size());
  names_.emplace_back(name);
  return names_.size() - 1;
}

void ChunkWriter::add(const WorkFrame& frame) {
  ++frames_;
  text_.whole(static_cast<std::uint64_t>(frame.index));
  text_.whole(names_->number_of(frame.source));
  text_.whole((frame.keyframe ? kKeyframe : 0) | (frame.optimiser_busy ? kBusy : 0) |
              (frame.optimised ? kOptimised : 0));
  for (const int value :
       {frame.features, frame.world_matches, frame.frame_matches, frame.inliers, frame.landmarks})
    text_.whole(static_cast<std::uint64_t>(value));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) text_.f64(frame.T_world_body(row, column));
  text_.whole(static_cast<std::uint64_t>(frame.start_ns));
  text_.integer(frame.seen);
  write_job(frame.front_end, false);
  if (!frame.optimised) return;
  text_.whole(frame.iterations.size());
  for (const work::Job& job : frame.iterations) write_job(job, true);
}

void ChunkWriter::write_job(const work::Job& job, bool on_controller) {
  text_.whole(job.stages.size());
  for (const work::StageRun& stage : job.stages) write_stage(stage, on_controller);
}

void ChunkWriter::write_stage(const work::StageRun& stage, bool on_controller) {
  text_.whole(names_->number_of(stage.stage));
  write_peak(stage.memory);
  text_.whole(stage.steps.size());
  std::string_view before;
  for (const work::Step& step : stage.steps) {
    if (const auto* serial = std::get_if<work::Serial>(&step)) {
      text_.whole(kSerial);
      write_counts({on_controller ? Kind::Controller : Kind::Serial, stage.stage, before, {}},
                   serial->counts);
    } else if (const auto* fork = std::get_if<work::Fork>(&step)) {
      text_.whole(fork->master_takes_part ? kForkWithMaster : kFork);
      text_.whole(names_->number_of(fork->name));
      const std::size_t workers = fork->shares.size() - (fork->master_takes_part ? 1 : 0);
      const Place place{Kind::Share, stage.stage, fork->name, {}};
      const std::uint64_t series = work_.number_of(place);
      text_.whole(series);
      for (std::size_t k = 0; k < workers; ++k) {
        work_.series[series].push_back(fork->shares[k]);
        write_kernels(place, fork->shares[k]);
      }
      if (fork->master_takes_part)
        write_counts({Kind::MasterShare, stage.stage, fork->name, {}}, fork->shares.back());
    } else if (const auto* transfer = std::get_if<work::Transfer>(&step)) {
      text_.whole(transfer->background ? kBackgroundTransfer : kTransfer);
      text_.whole(static_cast<std::uint64_t>(transfer->direction));
      text_.whole(static_cast<std::uint64_t>(transfer->bytes.count()));
    } else {
      text_.whole(kWait);
      text_.whole(static_cast<std::uint64_t>(std::get<work::TransferWait>(step).number));
    }
    before = label_of(step);
  }
}

void ChunkWriter::write_peak(const work::MemoryPeak& peak) {
  ByteWriter text;
  text.whole(static_cast<std::uint64_t>(peak.parallel.count()));
  text.whole(static_cast<std::uint64_t>(peak.single.count()));
  text.whole(peak.blocks.size());
  for (const work::Block& block : peak.blocks) {
    text.whole(names_->number_of(block.name));
    text.whole(static_cast<std::uint64_t>(block.offset.count()));
    text.whole(static_cast<std::uint64_t>(block.size.count()));
  }
  const auto [entry, is_new] = peaks_.emplace(text.take(), peaks_.size());
  text_.whole(is_new ? 0 : entry->second + 1);
  if (is_new) text_.append(entry->first);
}

std::uint64_t ChunkWriter::SeriesTable::number_of(const Place& place) {
  const auto [entry, is_new] = numbers.emplace(place, series.size());
  if (is_new) series.emplace_back();
  return entry->second;
}

void ChunkWriter::SeriesTable::write(ByteWriter& content) const {
  ByteWriter heads;
  ByteWriter columns;
  heads.whole(series.size());
  for (const std::vector<work::Counts>& one : series) write_series(one, heads, columns);
  content.text(heads.bytes());
  content.text(columns.bytes());
}

void ChunkWriter::write_counts(const Place& place, const work::Piece& piece) {
  const std::uint64_t series = work_.number_of(place);
  text_.whole(series);
  work_.series[series].push_back(piece);
  write_kernels(place, piece);
}

void ChunkWriter::write_kernels(const Place& place, const work::Piece& piece) {
  kernel_text_.whole(piece.kernels.size());
  for (const work::KernelWork& calls : piece.kernels) {
    const std::string_view kernel = work::kKernels[work::index(calls.kernel)].name;
    Place of_kernel = place;
    std::get<3>(of_kernel) = kernel;
    const std::uint64_t series = kernel_work_.number_of(of_kernel);
    kernel_text_.whole(names_->number_of(kernel));
    kernel_text_.whole(calls.calls);
    kernel_text_.whole(calls.items);
    kernel_text_.whole(series);
    kernel_work_.series[series].push_back(calls.counts);
  }
}

ChunkWriter::Contents ChunkWriter::finish() {
  ByteWriter content;
  content.whole(static_cast<std::uint64_t>(frames_));
  work_.write(content);
  content.append(text_.bytes());
  ByteWriter kernels;
  kernel_work_.write(kernels);
  kernels.append(kernel_text_.bytes());
  *this = ChunkWriter(*names_);
  return {content.take(), kernels.take()};
}

WorkFrames::WorkFrames(const WorkTrace& trace, bool kernels)
    : trace_(&trace), with_kernels_(kernels) {
  if (kernels && !trace.has_kernels())
    throw InputError(
        fmt::format("{}: is of version 1, which does not say what of the work was done in calls of "
                    "kernels that an accelerator could serve: record it again",
                    trace.name()));
}

bool WorkFrames::next(WorkFrame& frame) {
  throw_if_interrupted();
  if (frames_left_ == 0) {
    if (next_chunk_ == trace_->chunks().size()) return false;
    open_chunk();
  }
  read_facts(frame);
  read_job(frame.front_end, false);
  frame.iterations.resize(frame.optimised ? text_.count("iterations of the optimiser") : 0);
  for (work::Job& job : frame.iterations) read_job(job, true);
  ++frame_;
  if (--frames_left_ == 0) close_chunk();
  return true;
}

void WorkFrames::open_chunk() {
  const WorkTrace::Chunk& chunk = trace_->chunks()[next_chunk_++];
  place_ = fmt::format("{}, frames {} to {} (section at byte {})", trace_->name(), chunk.first,
                       chunk.first + chunk.frames - 1, chunk.section.offset);
  content_ = unpacked(chunk.section, trace_->name());
  text_ = ByteReader(content_, place_);
  frames_left_ = chunk.frames;
  const std::uint64_t frames = text_.whole("the number of frames");
  if (frames != static_cast<std::uint64_t>(chunk.frames))
    text_.fail(fmt::format("holds {} frames; expected {}", frames, chunk.frames));
  open_series(text_, series_);
  peaks_.clear();
  if (!with_kernels_) return;
  kernel_place_ = fmt::format("{}, kernels of frames {} to {} (section at byte {})", trace_->name(),
                              chunk.first, chunk.first + chunk.frames - 1, chunk.kernels->offset);
  kernel_content_ = unpacked(*chunk.kernels, trace_->name());
  kernel_text_ = ByteReader(kernel_content_, kernel_place_);
  open_series(kernel_text_, kernel_series_);
}

void WorkFrames::open_series(ByteReader& in, std::vector<SeriesReader>& series) {
  const std::string& place = in.place();
  ByteReader heads(in.text("series"), place);
  ByteReader columns(in.text("columns"), place);
  series.clear();
  const std::size_t number = heads.count("the number of series");
  series.reserve(number);
  for (std::size_t i = 0; i < number; ++i) series.emplace_back(heads, columns, trace_->fields());
  heads.expect_end();
  columns.expect_end();
}

void WorkFrames::close_chunk() {
  text_.expect_end();
  for (SeriesReader& series : series_) series.expect_end();
  if (!with_kernels_) return;
  kernel_text_.expect_end();
  for (SeriesReader& series : kernel_series_) series.expect_end();
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
  frame.features = number("features");
  frame.world_matches = number("world matches");
  frame.frame_matches = number("frame matches");
  frame.inliers = number("inliers");
  frame.landmarks = number("landmarks");
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
  job.stages.resize(text_.count("stages of a job"));
  for (work::StageRun& stage : job.stages) read_stage(stage, on_controller);
  if (waits_ != background_)
    text_.fail(
        fmt::format("a job waits {} times for {} background transfers", waits_, background_));
}

void WorkFrames::read_stage(work::StageRun& stage, bool on_controller) {
  stage.stage = read_name();
  read_peak(stage.memory);
  stage.steps.resize(text_.count("steps of a stage"));
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
    case kForkWithMaster: {
      auto* fork = std::get_if<work::Fork>(&step);
      if (fork == nullptr) fork = &step.emplace<work::Fork>();
      fork->master_takes_part = kind == kForkWithMaster;
      read_fork(*fork, on_controller);
      return;
    }
    case kTransfer:
    case kBackgroundTransfer: {
      const auto direction = static_cast<work::Direction>(
          text_.whole_below(kDirections, "the direction of a transfer"));
      if (!on_controller && !work::is_between_l1_and_l2(direction))
        text_.fail("a transfer of the cluster from or to external memory, which it cannot reach");
      const Bytes bytes(
          static_cast<std::int64_t>(text_.whole_below(kMostBytes, "bytes of a transfer")));
      const bool background = kind == kBackgroundTransfer;
      background_ += background;
      step.emplace<work::Transfer>(work::Transfer{direction, bytes, background});
      return;
    }
    default:
      ++waits_;
      step.emplace<work::TransferWait>(
          work::TransferWait{static_cast<std::int32_t>(text_.whole_below(
              static_cast<std::uint64_t>(background_), "the number of a background transfer"))});
  }
}

void WorkFrames::read_fork(work::Fork& fork, bool on_controller) {
  fork.name = read_name();
  const auto workers = static_cast<std::size_t>(on_controller ? 1 : trace_->info().cores);
  fork.shares.resize(workers + (fork.master_takes_part ? 1 : 0));
  const std::uint64_t series = text_.whole("a series");
  for (std::size_t k = 0; k < workers; ++k) read_counts(series, fork.shares[k]);
  if (fork.master_takes_part) read_counts(text_.whole("a series"), fork.shares.back());
}

void WorkFrames::read_peak(work::MemoryPeak& peak) {
  const std::uint64_t number = text_.whole_below(peaks_.size() + 1, "the number of a memory peak");
  if (number > 0) {
    peak = peaks_[number - 1];
    return;
  }
  const auto bytes = [&] {
    return Bytes(static_cast<std::int64_t>(text_.whole_below(kMostBytes, "bytes of memory")));
  };
  peak.parallel = bytes();
  peak.single = bytes();
  peak.blocks.resize(text_.count("blocks of memory"));
  for (work::Block& block : peak.blocks) {
    block.name = read_name();
    block.offset = bytes();
    block.size = bytes();
  }
  peaks_.push_back(peak);
}

void WorkFrames::read_counts(std::uint64_t series, work::Piece& piece) {
  if (series >= series_.size()) [[unlikely]]
    text_.fail(
        fmt::format("a piece of work is of series {}; there are {}", series, series_.size()));
  series_[series].next(piece);
  if (with_kernels_) read_kernels(piece);
}

void WorkFrames::read_kernels(work::Piece& piece) {
  piece.kernels.resize(kernel_text_.whole_below(work::kKernelCount + 1, "the number of kernels"));
  std::size_t least = 0;  // each kind at most once, in their order
  for (work::KernelWork& calls : piece.kernels) {
    const std::string& name =
        trace_->names()[kernel_text_.whole_below(trace_->names().size(), "the number of a name")];
    while (least < work::kKernelCount && work::kKernels[least].name != name) ++least;
    if (least == work::kKernelCount)
      kernel_text_.fail(
          fmt::format("'{}' is no kernel that is known, or comes twice in a piece of work", name));
    calls.kernel = work::kKernels[least++].kernel;
    calls.calls = kernel_text_.whole_below(std::uint64_t{1} << kCounterBits, "calls of a kernel");
    calls.items = kernel_text_.whole_below(std::uint64_t{1} << kCounterBits, "items of a kernel");
    const std::uint64_t series =
        kernel_text_.whole_below(kernel_series_.size(), "a series of kernels");
    kernel_series_[series].next(calls.counts);
    for (std::size_t i = 0; i < work::kOpCount; ++i)
      if (calls.counts.n[i] > piece.n[i])
        kernel_text_.fail("a call of a kernel counts more than its piece of work");
  }
}

}  // namespace leviosim::traces
