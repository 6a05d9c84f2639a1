// Writes the frames of a work trace: the classes NameTable and ChunkWriter of work_frames.h.
#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_frames.h"

namespace leviosim::traces {
namespace {

/// What stands before a segment of serial work, which tells it from others of its stage.
std::string_view label_of(const work::Step& step) {
  if (const auto* fork = std::get_if<work::Fork>(&step)) return fork->name;
  return std::holds_alternative<work::Serial>(step) ? "serial" : "transfer";
}

std::uint64_t kind_of(const work::Fork& fork) {
  if (fork.master_takes_part) return kForkWithMaster;
  return fork.aligned_on_one_core ? kForkAlignedOnOneCore : kFork;
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
  for (const int fact : frame.facts) text_.whole(static_cast<std::uint64_t>(fact));
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
      text_.whole(kind_of(*fork));
      text_.whole(names_->number_of(fork->name));
      const std::size_t workers = fork->shares.size() - (fork->master_takes_part ? 1 : 0);
      const Place place{Kind::Share, stage.stage, fork->name, {}};
      const std::uint64_t series = work_.number_of(place);
      text_.whole(series);
      for (std::size_t k = 0; k < workers; ++k) {
        work_.series[series].push_back(fork->shares[k]);
        write_offload(place, fork->shares[k]);
      }
      if (fork->master_takes_part)
        write_counts({Kind::MasterShare, stage.stage, fork->name, {}}, fork->shares.back());
    } else if (const auto* transfer = std::get_if<work::Transfer>(&step)) {
      text_.whole(transfer->background ? kBackgroundTransfer : kTransfer);
      text_.whole(static_cast<std::uint64_t>(transfer->direction));
      text_.whole(static_cast<std::uint64_t>(transfer->bytes.count()));
      if (transfer->background) text_.whole(static_cast<std::uint64_t>(transfer->more.count()));
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
  for (const CountsSeries& one : series) write_series(one, heads, columns);
  content.text(heads.bytes());
  content.text(columns.bytes());
}

void ChunkWriter::write_counts(const Place& place, const work::Segment& segment) {
  const std::uint64_t series = work_.number_of(place);
  text_.whole(series);
  work_.series[series].push_back(segment);
  write_offload(place, segment);
}

void ChunkWriter::write_offload(const Place& place, const work::Segment& segment) {
  offload_text_.whole(segment.offload.size());
  for (const work::OffloadWork& calls : segment.offload) {
    const std::string_view kernel = work::kOffloadKinds[work::index(calls.kernel)].name;
    Place of_kernel = place;
    std::get<3>(of_kernel) = kernel;
    const std::uint64_t series = offload_work_.number_of(of_kernel);
    offload_text_.whole(names_->number_of(kernel));
    offload_text_.whole(calls.calls);
    offload_text_.whole(calls.items);
    offload_text_.whole(series);
    offload_work_.series[series].push_back(calls.counts);
  }
}

ChunkWriter::Contents ChunkWriter::finish() {
  ByteWriter content;
  content.whole(static_cast<std::uint64_t>(frames_));
  work_.write(content);
  content.append(text_.bytes());
  ByteWriter offload;
  offload_work_.write(offload);
  offload.append(offload_text_.bytes());
  *this = ChunkWriter(*names_);
  return {content.take(), offload.take()};
}

}  // namespace leviosim::traces
