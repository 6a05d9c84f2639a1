#include "sim/work/machine.h"

#include "sim/base/check.h"

namespace leviosim::work {

Machine::Machine(const MachineConfig& config)
    : config_(config),
      local_(config.memory, config.capacity, config.alignment),
      behind_("external memory", config.external) {
  check(config.cores >= 1, "a machine has at least one core");
  if (config.record && config.code != nullptr)
    tracker_.emplace(*config.code, code_of(config.cores) + 1);
}

void Machine::set_behind(Arena behind, Bytes kept) {
  behind_ = std::move(behind);
  kept_ = kept;
}

void Machine::follow_code_of(int core) {
  if (!tracker_) return;
  tracker_->select(code_of(core));
  current_code = &*tracker_;
}

Segment Machine::counted_so_far() {
  fetch_code();
  std::vector<OffloadWork> offload = take_offload();
  return {take_tally(), std::move(offload)};
}

void Machine::begin_stage(std::string_view name) {
  check(!in_stage_, "stages do not nest");
  in_stage_ = true;
  stage_ = name;
  local_.set_user(name);
  behind_.set_user(name);
  local_.reset_peak();
  fork_peak_ = {};
  if (!recording()) return;
  counted_so_far();  // what happened between stages belongs to none
  follow_code_of(config_.cores);
  offload_followed = config_.offload;
  job_.stages.push_back({name, {}, {}});
}

void Machine::end_stage() {
  in_stage_ = false;
  if (!recording()) return;
  flush_serial();
  current_code = nullptr;
  offload_followed = true;
  MemoryPeak& memory = job_.stages.back().memory;
  memory = fork_peak_;
  memory.single = std::max(memory.single, local_.peak());
  if (local_.peak() >= memory.parallel) {
    memory.parallel = local_.peak();
    memory.blocks = local_.blocks_at_peak();
  }
}

void Machine::begin_fork(std::string_view name) {
  check(in_stage_, "a fork belongs to a stage");
  scratch_sum_ = scratch_max_ = Bytes(0);
  fork_ = {name, {}, false};
  if (!recording()) return;
  flush_serial();
  fork_.shares.reserve(static_cast<std::size_t>(config_.cores));
}

void Machine::end_share(Bytes scratch_peak) {
  scratch_sum_ += scratch_peak;
  scratch_max_ = std::max(scratch_max_, scratch_peak);
  if (recording()) fork_.shares.push_back(counted_so_far());
}

void Machine::end_fork() {
  if (!recording()) return;
  follow_code_of(config_.cores);
  fork_peak_.single = std::max(fork_peak_.single, local_.used() + scratch_max_);
  if (local_.used() + scratch_sum_ > fork_peak_.parallel) {
    fork_peak_.parallel = local_.used() + scratch_sum_;
    fork_peak_.blocks = local_.live();
    if (scratch_sum_ > Bytes(0))
      fork_peak_.blocks.push_back({"scratch of the cores", local_.used(), scratch_sum_});
  }
  job_.stages.back().steps.emplace_back(std::move(fork_));
}

int Machine::workers_with(Bytes scratch) const {
  if (scratch == Bytes(0)) return config_.cores;
  // What is lent begins at an aligned place.
  const Bytes each = scratch + Bytes(config_.alignment - 1);
  if (scratch > local_.free()) throw local_.overflow("scratch of a core", scratch);
  return static_cast<int>(
      std::clamp<std::int64_t>(local_.free().count() / each.count(), 1, config_.cores));
}

void Machine::note_tile(std::string_view block, Bytes bytes) {
  const auto known = std::find_if(passages_.begin(), passages_.end(), [&](const Passage& p) {
    return p.stage == stage_ && p.block == block;
  });
  Passage& passage =
      known != passages_.end() ? *known : passages_.emplace_back(Passage{stage_, block});
  ++passage.tiles;
  passage.bytes += bytes;
}

void Machine::note_transfer(const Transfer& transfer) {
  if (!recording()) return;
  check(in_stage_, "a transfer belongs to a stage");
  flush_serial();
  job_.stages.back().steps.emplace_back(transfer);
}

void Machine::wait(Ticket ticket) {
  check(ticket.number_ >= 0 && ticket.number_ < background_transfers_,
        "one waits for a transfer that was started in the same job");
  ++waits_;
  if (!recording()) return;
  flush_serial();
  job_.stages.back().steps.emplace_back(TransferWait{ticket.number_});
}

void Machine::flush_serial() {
  Segment counts = counted_so_far();
  if (!counts.empty()) job_.stages.back().steps.emplace_back(Serial{std::move(counts)});
}

Job Machine::take_job() {
  check_equal(waits_, background_transfers_, "waits for background transfers");
  waits_ = background_transfers_ = 0;
  return std::exchange(job_, {});
}

}  // namespace leviosim::work
