#include "tools/app/comparison/cycle_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/base/csv.h"
#include "sim/chip/accelerator.h"

namespace leviosim::tools {
namespace {

using sim::UsefulCycles;

/// As the file has it, so that a run and its folder tell the same.
double rounded_part(double value) { return std::round(value * 1e3) / 1e3; }

struct PricedMechanism {
  std::string_view key;
  double UsefulCycles::*of;
};
constexpr std::array kPriced{PricedMechanism{"issue", &UsefulCycles::issue},
                             PricedMechanism{"load_use", &UsefulCycles::load_use},
                             PricedMechanism{"control", &UsefulCycles::control},
                             PricedMechanism{"memory", &UsefulCycles::memory},
                             PricedMechanism{"arithmetic", &UsefulCycles::arithmetic},
                             PricedMechanism{"fetch", &UsefulCycles::fetch}};

/// Of a stage as a whole.
struct TeamMechanism {
  std::string_view key;
  double sim::CycleBreakdown::*of;
};
constexpr std::array kOfTheTeam{
    TeamMechanism{"fpu", &sim::CycleBreakdown::fpu},
    TeamMechanism{"divider", &sim::CycleBreakdown::divider},
    TeamMechanism{"banks", &sim::CycleBreakdown::banks},
    TeamMechanism{"fetch_contention", &sim::CycleBreakdown::fetch},
    TeamMechanism{"accelerator_contention", &sim::CycleBreakdown::accelerator},
    TeamMechanism{"imbalance", &sim::CycleBreakdown::imbalance},
    TeamMechanism{"synchronisation", &sim::CycleBreakdown::synchronisation},
    TeamMechanism{"transfer", &sim::CycleBreakdown::transfer},
    TeamMechanism{"rounding", &sim::CycleBreakdown::rounding},
};

constexpr std::string_view kOther = "other";

template <class Keep>
StageParts folded_unless(const StageParts& stage, Keep&& keep) {
  StageParts result{stage.stage, stage.on_controller, stage.cycles, {}};
  CyclePart other{"", std::string(kOther), "", 0, 0};
  for (const CyclePart& part : stage.parts) {
    if (part.mechanism != kOther && keep(part))
      result.parts.push_back(part);
    else
      other.cycles += part.cycles;
  }
  other.cycles = rounded_part(other.cycles);
  if (other.cycles != 0) result.parts.push_back(other);
  return result;
}

}  // namespace

/// The parts of one stage, in core-cycles over the cores.
class PartList {
 public:
  explicit PartList(double cores) : cores_(cores) {}

  void add(std::string_view where, std::string_view mechanism, std::string_view operation,
           double core_cycles, double count = 0) {
    const double cycles = rounded_part(core_cycles / cores_);
    if (cycles == 0 && count == 0) return;
    parts_.push_back(
        {std::string(where), std::string(mechanism), std::string(operation), cycles, count});
  }
  std::vector<CyclePart> take() { return std::move(parts_); }

 private:
  double cores_;
  std::vector<CyclePart> parts_;
};

std::string_view describe_mechanism(std::string_view key) {
  const auto it = std::find_if(kMechanisms.begin(), kMechanisms.end(),
                               [&](const Mechanism& m) { return m.key == key; });
  return it == kMechanisms.end() ? std::string_view() : it->description;
}

CycleParts::CycleParts(const sim::ChipConfig& chip, int cores)
    : chip_(chip),
      cores_(cores),
      worker_code_(chip.cluster.icache, chip.cluster.icache.worker, cores),
      master_code_(chip.cluster.icache, chip.cluster.icache.master, 1),
      controller_code_(chip.controller.icache, chip.controller.icache.worker, 1) {}

CycleParts::Stage& CycleParts::find(std::string_view name, bool on_controller) {
  const auto it = std::find_if(stages_.begin(), stages_.end(),
                               [&](const Stage& stage) { return stage.name == name; });
  if (it != stages_.end()) return *it;
  return stages_.emplace_back(Stage{std::string(name), on_controller, 0, {}, {}});
}

CycleParts::Place& CycleParts::place(Stage& stage, std::string_view name) {
  const auto it = std::find_if(stage.places.begin(), stage.places.end(),
                               [&](const Place& p) { return p.name == name; });
  if (it != stage.places.end()) return *it;
  Place& added = stage.places.emplace_back();
  added.name = name;
  return added;
}

const sim::Accelerators& CycleParts::accelerators_of(const Stage& stage) const {
  return stage.on_controller ? chip_.controller.accelerators : chip_.cluster.accelerators;
}

const sim::CoreConfig& CycleParts::core_of(const Stage& stage) const {
  return stage.on_controller ? chip_.controller.core : chip_.cluster.core;
}

void CycleParts::add_segment(const Stage& stage, Place& place, const work::Segment& segment) const {
  place.all += segment;
  place.left.add(segment.offload.empty() ? work::Counts(segment)
                                         : sim::left_to_core(segment, accelerators_of(stage)),
                 core_of(stage).code);
}

void CycleParts::add_steps(Stage& stage, const work::StageRun& run) {
  // A controller runs all steps of a stage as one.
  if (stage.on_controller) {
    const work::Segment all = work::segments_of(run);
    Place& alone = place(stage, kSerialPlace);
    add_segment(stage, alone, all);
    alone.fetch += controller_code_.fetch(all.code).stall;
    return;
  }
  for (const work::Step& step : run.steps) {
    if (const auto* serial = std::get_if<work::Serial>(&step)) {
      Place& alone = place(stage, kSerialPlace);
      add_segment(stage, alone, serial->counts);
      alone.fetch += master_code_.fetch(serial->counts.code).stall;
    }
    if (const auto* fork = std::get_if<work::Fork>(&step)) add_fork(stage, *fork);
  }
}

void CycleParts::add_fork(Stage& stage, const work::Fork& fork) {
  // What the master does beside the workers is not in the account: they wait for it, or do not.
  const std::size_t shares = fork.shares.size() - (fork.master_takes_part ? 1 : 0);
  Place& here = place(stage, fork.name);
  for (std::size_t i = 0; i < shares; ++i) add_segment(stage, here, fork.shares[i]);
}

/// What the work of a place costs lone cores, operation by operation, and its code.
/// @param factor  core-cycles that go by in a cycle of the work
/// @returns its price in core-cycles
double CycleParts::add_priced(PartList& list, const Stage& stage, const Place& place,
                              double factor) const {
  const sim::CoreConfig& core = core_of(stage);
  double total = 0;
  const auto add = [&](std::string_view operation, const UsefulCycles& price, double count) {
    total += price.total() * factor;
    for (const PricedMechanism& m : kPriced)
      if (price.*m.of != 0) list.add(place.name, m.key, operation, price.*m.of * factor, count);
    if (price.total() == 0) list.add(place.name, "issue", operation, 0, count);
  };
  for (const work::OpInfo& op : work::kOps)
    if (const double count = place.left.count(op.op); count > 0)
      add(op.name, place.left.price(op.op, core), count);
  const auto bytes = std::accumulate(place.all.code.begin(), place.all.code.end(), 0.0);
  if (bytes > 0) add("code", UsefulCycles{.fetch = place.fetch}, bytes);
  const sim::Accelerators& accelerators = accelerators_of(stage);
  for (const work::OffloadWork& calls : place.all.offload) {
    if (accelerators[work::index(calls.kernel)].units == 0) continue;
    const sim::Service service = sim::service_of(calls, accelerators);
    const std::string_view kernel = work::kOffloadKinds[work::index(calls.kernel)].name;
    const auto items = static_cast<double>(calls.items);
    list.add(place.name, "issue", kernel, service.instructions * factor, items);
    list.add(place.name, "accelerator", kernel, service.waiting * factor, items);
    total += (service.instructions + service.waiting) * factor;
  }
  return total;
}

/// What all forks of a stage waited for code is known; it is divided as the prices of their sums
/// are.
void CycleParts::divide_fetches(std::vector<Place>& places, double cycles) const {
  double all = 0;
  for (Place& place : places)
    if (place.name != kSerialPlace) all += place.fetch = worker_code_.fetch(place.all.code).stall;
  for (Place& place : places)
    if (place.name != kSerialPlace && all > 0) place.fetch *= cycles / all;
}

void CycleParts::add(const work::Job& job, const sim::JobTiming& timing, bool on_controller) {
  for (std::size_t i = 0; i < job.stages.size(); ++i) {
    Stage& stage = find(job.stages[i].stage, on_controller);
    stage.cycles += timing.stages[i].cycles.count();
    stage.breakdown += timing.stages[i].breakdown;
    add_steps(stage, job.stages[i]);
  }
}

void CycleParts::on_front_end(const FrontEndJob& job) {
  add(job.job, job.parallel, false);
  offload_cycles_ += job.result.cycles.count();
  for (const sim::StageTiming& stage : job.parallel.stages) offload_cycles_ -= stage.cycles.count();
}

void CycleParts::on_optimiser(const OptimiserJob& job) { add(job.job, job.timing, true); }

std::vector<StageParts> CycleParts::stages() const {
  std::vector<StageParts> result;
  for (const Stage& stage : stages_) {
    const int cores = stage.on_controller ? 1 : cores_;
    PartList list(cores);
    double serial = 0;
    std::vector<Place> places = stage.places;
    if (!stage.on_controller) divide_fetches(places, stage.breakdown.useful.fetch);
    for (const Place& p : places) {
      const bool master_alone = !stage.on_controller && p.name == kSerialPlace;
      const double price = add_priced(list, stage, p, master_alone ? cores : 1);
      if (master_alone) serial += price;
    }
    if (!stage.on_controller)
      list.add(kSerialPlace, "rounding", "", stage.breakdown.serial - serial);
    for (const TeamMechanism& m : kOfTheTeam) list.add("", m.key, "", stage.breakdown.*m.of);
    result.push_back(
        {stage.name, stage.on_controller, static_cast<double>(stage.cycles), list.take()});
  }
  PartList offload(1);
  const auto cycles = static_cast<double>(offload_cycles_);
  offload.add("", "offload", "", cycles);
  if (offload_cycles_ != 0) result.push_back({kOffloadStage, false, cycles, offload.take()});
  return result;
}

StageParts folded(const StageParts& stage, double least_share) {
  return folded_unless(stage, [&](const CyclePart& part) {
    return std::abs(part.cycles) >= least_share * stage.cycles;
  });
}

StageParts folded_like(const StageParts& stage, const StageParts& other) {
  return folded_unless(stage, [&](const CyclePart& part) {
    return std::any_of(other.parts.begin(), other.parts.end(), [&](const CyclePart& p) {
      return p.where == part.where && p.mechanism == part.mechanism &&
             p.operation == part.operation;
    });
  });
}

std::string cycles_csv(const std::vector<StageParts>& stages) {
  std::string text = "stage,runs_on,where,mechanism,operation,cycles,count\n";
  for (const StageParts& stage : stages) {
    const char* runs_on = stage.on_controller ? "controller" : "cluster";
    text += fmt::format("{},{},,total,,{:.3f},0\n", stage.stage, runs_on, stage.cycles);
    for (const CyclePart& part : stage.parts)
      text += fmt::format("{},{},{},{},{},{:.3f},{:.0f}\n", stage.stage, runs_on, part.where,
                          part.mechanism, part.operation, part.cycles, part.count);
  }
  return text;
}

std::vector<StageParts> parse_cycles(const std::filesystem::path& file, std::string text) {
  enum { kStage, kRunsOn, kWhere, kMechanism, kOperation, kCycles, kCount };
  base::CsvReader reader(file, base::Separator::comma,
                         {"stage", "runs_on", "where", "mechanism", "operation", "cycles", "count"},
                         std::move(text));
  std::vector<StageParts> stages;
  bool is_header = true;
  while (const base::CsvRow* row = reader.next()) {
    if (std::exchange(is_header, false)) {
      if (row->text(kStage) != "stage") row->fail(kStage, "no title; expected stage");
      continue;
    }
    const std::string mechanism(row->text(kMechanism));
    if (mechanism == "total") {
      stages.push_back({std::string(row->text(kStage)),
                        row->text(kRunsOn) == "controller",
                        row->number(kCycles),
                        {}});
      continue;
    }
    if (describe_mechanism(mechanism).empty()) row->fail(kMechanism, "no mechanism");
    if (stages.empty() || stages.back().stage != row->text(kStage))
      row->fail(kStage, "a stage without its total before it");
    stages.back().parts.push_back({std::string(row->text(kWhere)), mechanism,
                                   std::string(row->text(kOperation)), row->number(kCycles),
                                   row->number(kCount)});
  }
  return stages;
}

}  // namespace leviosim::tools
