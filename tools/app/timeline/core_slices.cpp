#include "tools/app/timeline/core_slices.h"

#include <fmt/core.h>

#include <algorithm>

#include "tools/app/timeline/waits.h"

namespace leviosim::tools {
namespace {

/// Waits below this share of a slice stand in its annotations only.
constexpr double kLeastDrawn = 0.01;

/// In their order.
constexpr std::array<std::string_view, 4> kDirections{"L2 to L1", "L1 to L2", "external to L2",
                                                      "L2 to external"};

void annotate(std::vector<Annotation>& notes, const sim::MechanismCycles& t) {
  notes.push_back({"work", own_work(t)});
  for (const Wait& wait : kWaits)
    if (const double cycles = wait.of(t); cycles != 0) notes.push_back({wait.name, cycles});
  if (const double rest = t[sim::Mechanism::Rounding]; rest != 0)
    notes.push_back({"rounding", rest});
}

}  // namespace

std::int64_t nanoseconds(const sim::Timebase& timebase, sim::Time time) {
  return timebase.whole_nanoseconds(time - sim::Time{});
}

void CoreSlices::add(const StageEvents& stage) {
  for (const StepEvents& step : stage.steps) add_step(step);
}

void CoreSlices::add_step(const StepEvents& step) {
  add_master(step);
  for (const CoreEvents& core : step.cores) {
    if (tracks_.cores[static_cast<std::size_t>(core.core)] == master()) continue;
    add_work(step, core);
    if (step.kind == StepKind::Fork) add_idle(step, core);
  }
  for (const TransferEvents& transfer : step.transfers) add_transfer(transfer);
}

/// The whole step, and in it what the master works.
void CoreSlices::add_master(const StepEvents& step) {
  const auto own = std::find_if(step.cores.begin(), step.cores.end(), [&](const CoreEvents& c) {
    return tracks_.cores[static_cast<std::size_t>(c.core)] == master();
  });
  if (step.kind == StepKind::Serial) {
    if (own != step.cores.end()) add_work(step, *own);
    return;
  }
  std::string name;
  std::vector<Annotation> notes{{"cycle", cycle(step.begin)}, {"cycles", step.cycles.count()}};
  if (step.synchronisation != 0) notes.push_back({"synchronisation", step.synchronisation});
  if (step.kind == StepKind::Fork) name = fmt::format("fork: {}", step.name);
  if (step.kind == StepKind::Transfer) name = "DMA";
  if (step.kind == StepKind::Wait) name = "waiting for the DMA";
  if (step.kind == StepKind::Several) {
    name = "short steps";
    notes.push_back({"steps", std::int64_t{step.steps}});
    notes.push_back({"serial", step.serial.count()});
    notes.push_back({"transfer", step.transfer.count()});
  }
  writer_.begin(master(), ns(step.begin), {name, false, std::move(notes)});
  if (own != step.cores.end()) add_work(step, *own);
  writer_.end(master(), ns(step.end));
}

void CoreSlices::add_work(const StepEvents& step, const CoreEvents& core) {
  const std::uint64_t track = tracks_.cores[static_cast<std::size_t>(core.core)];
  std::string_view name = step.name;
  if (step.kind == StepKind::Serial) name = "serial work";
  if (step.kind == StepKind::Several) name = "work in short steps";
  std::vector<Annotation> notes{{"cycle", cycle(core.begin)}, {"cycles", core.worked.count()}};
  annotate(notes, core.split);
  if (step.kind == StepKind::Several && track != master())
    notes.push_back({"idle", core.idle.count()});
  writer_.begin(track, ns(core.begin), {name, false, std::move(notes)});
  if (step.kind != StepKind::Several) add_waits(track, core);
  writer_.end(track, ns(core.end));
}

/// The shares of waiting of a work segment are known, but not their order: they are laid one after
/// the other at its end.
void CoreSlices::add_waits(std::uint64_t track, const CoreEvents& core) {
  const auto worked = static_cast<double>(core.worked.count());
  double left = 0;
  for (const Wait& wait : kWaits)
    if (wait.of(core.split) >= kLeastDrawn * worked) left += wait.of(core.split);
  if (left <= 0) return;
  const auto before_end = [&](double cycles) {
    const double ticks = std::max(cycles, 0.0) * static_cast<double>(clock_.period().count());
    return std::max(core.begin, core.end - sim::Duration(static_cast<std::int64_t>(ticks)));
  };
  sim::Time at = before_end(left);
  for (const Wait& wait : kWaits) {
    const double cycles = wait.of(core.split);
    if (cycles < kLeastDrawn * worked || cycles <= 0) continue;
    writer_.begin(track, ns(at), {fmt::format("waiting for {}", wait.name)});
    at = std::max(at, before_end(left -= cycles));
    writer_.end(track, ns(at));
  }
}

/// Until the slowest core is done, and the barrier.
void CoreSlices::add_idle(const StepEvents& step, const CoreEvents& core) {
  const std::uint64_t track = tracks_.cores[static_cast<std::size_t>(core.core)];
  writer_.begin(track, ns(core.end), {"idle", false, {{"cycles", core.idle.count()}}});
  writer_.end(track, ns(step.end));
}

void CoreSlices::add_transfers(const StageEvents& stage) {
  for (const StepEvents& step : stage.steps)
    for (const TransferEvents& transfer : step.transfers) add_transfer(transfer);
}

void CoreSlices::add_transfer(const TransferEvents& transfer) {
  const auto direction = static_cast<std::size_t>(transfer.direction);
  const std::uint64_t track = tracks_.transfers[direction];
  std::vector<Annotation> notes{{"cycle", cycle(transfer.begin)},
                                {"bytes", transfer.bytes.count()}};
  if (transfer.transfers > 1) notes.push_back({"transfers", std::int64_t{transfer.transfers}});
  if (transfer.tiles > 1) notes.push_back({"tiles", std::int64_t{transfer.tiles}});
  const bool is_tile = transfer.tiles > 0 && transfer.tiles == transfer.transfers;
  const std::string name = fmt::format("{}{}", is_tile ? "tile, " : "", kDirections[direction]);
  writer_.begin(track, ns(transfer.begin), {name, false, std::move(notes)});
  writer_.end(track, ns(transfer.end));
}

}  // namespace leviosim::tools
