#include "platform_models/loader/fields.h"

#include <fmt/format.h>

#include <utility>

#include "platform_models/loader/accelerator_fields.h"
#include "platform_models/loader/energy_fields.h"
#include "platform_models/loader/member_values.h"
#include "sim/work/op.h"

namespace leviosim::platform {
namespace {

using sim::ChipConfig;

// Limits that keep typing errors out; they are far outside of any chip of this class.
constexpr double kMaxCost = 1e5;     // cycles of an operation or a latency
constexpr double kMaxParts = 1024;   // cores, banks, units
constexpr double kLeastTime = 1e-3;  // of what something is divided by
constexpr double kMaxSize = 1e12;    // bytes

Field quantity(std::string path, const Dimension& dimension, double min, double max,
               std::string description) {
  Field field;
  field.path = path;
  field.record = std::move(path);
  field.name = "value";
  field.dimension = &dimension;
  field.min = min;
  field.max = max;
  field.description = std::move(description);
  return field;
}

/// @param choices  names in the order of the enumeration
Field choice(std::string path, std::vector<std::string> choices, std::string description) {
  const auto last = static_cast<double>(choices.size() - 1);
  Field field = quantity(std::move(path), kChoice, 0, last, std::move(description));
  field.choices = std::move(choices);
  return field;
}

Field optional(Field field) {
  field.required = false;
  return field;
}

/// Makes a field a column of a row of several: "isa.ops.int_mul.issue" is in "isa.ops.int_mul".
Field column(Field field) {
  const std::size_t dot = field.path.rfind('.');
  field.record = field.path.substr(0, dot);
  field.name = field.path.substr(dot + 1);
  return field;
}

/// A section about cores: what all have in common, or what is different for some.
struct CoreSection {
  std::string path;
  bool cluster;
  bool controller;

  bool common() const { return cluster && controller; }
};

class Table {
 public:
  /// @param member  returns a reference to the field's place in a ChipConfig, const or not
  template <class Member>
  void add(Field field, Member member) {
    field.set = [member](ChipConfig& chip, double value) { put(member(chip), value); };
    field.get = [member](const ChipConfig& chip) { return as_number(member(chip)); };
    fields_.push_back(std::move(field));
  }

  /// @param member  returns a reference to the field's place in a CoreConfig, const or not
  template <class Member>
  void add_of_cores(const CoreSection& section, Field field, Member member) {
    field.required = field.required && section.common();
    field.set = [section, member](ChipConfig& chip, double value) {
      if (section.cluster) put(member(chip.cluster.core), value);
      if (section.controller) put(member(chip.controller.core), value);
    };
    field.get = [section, member](const ChipConfig& chip) {
      return as_number(member(section.cluster ? chip.cluster.core : chip.controller.core));
    };
    fields_.push_back(std::move(field));
  }

  void append(std::vector<Field> fields) {
    for (Field& field : fields) fields_.push_back(std::move(field));
  }

  std::vector<Field> take() { return std::move(fields_); }

 private:
  std::vector<Field> fields_;
};

void add_operation(Table& table, const CoreSection& section, const work::OpInfo& info) {
  const std::string row = fmt::format("{}.ops.{}", section.path, info.name);
  const work::Op op = info.op;
  // Files may be older, and only cores with hardware loops have a cost for loop_jump.
  const auto needed = [op](Field field) {
    const bool newer = op == work::Op::LoopJump || op == work::Op::IntAddShift;
    return newer ? optional(std::move(field)) : field;
  };
  table.add_of_cores(
      section,
      needed(column(
          quantity(row + ".issue", kCycles, 0, kMaxCost,
                   fmt::format("instructions issued, one per cycle: {}", info.description)))),
      [op](auto& core) -> auto& { return core.ops[work::index(op)].issue; });
  table.add_of_cores(
      section,
      needed(column(
          quantity(row + ".stall", kCycles, 0, kMaxCost,
                   fmt::format("cycles that the core waits in addition: {}", info.description)))),
      [op](auto& core) -> auto& { return core.ops[work::index(op)].stall; });
  table.add_of_cores(
      section,
      optional(
          column(quantity(row + ".busy", kCycles, kLeastTime, kMaxCost,
                          fmt::format("cycles that its unit is occupied: {}", info.description)))),
      [op](auto& core) -> auto& { return core.ops[work::index(op)].busy; });
  table.add_of_cores(
      section,
      needed(column(choice(row + ".on", {"core", "fpu", "divider", "int64", "bank"},
                           fmt::format("unit that does the work: {}", info.description)))),
      [op](auto& core) -> auto& { return core.ops[work::index(op)].unit; });
  table.add_of_cores(
      section,
      optional(column(choice(row + ".routine", {"false", "true"},
                             fmt::format("whole library routine: {}", info.description)))),
      [op](auto& core) -> auto& { return core.ops[work::index(op)].routine; });
}

/// Instruction set and code generation.
void add_core(Table& table, const CoreSection& section) {
  const auto key = [&](std::string_view name) { return fmt::format("{}.{}", section.path, name); };
  table.add_of_cores(
      section,
      optional(quantity(key("unmeasured_instructions"), kRatio, 0.1, 10,
                        "ratio of executed to counted instructions in code that was not measured")),
      [](auto& core) -> auto& { return core.unmeasured_instructions; });
  table.add_of_cores(
      section,
      quantity(key("load_use_fraction"), kRatio, 0, 1,
               "share of loads whose result the next instruction uses"),
      [](auto& core) -> auto& { return core.load_use_fraction; });
  table.add_of_cores(
      section,
      quantity(key("load_use_stall"), kCycles, 0, kMaxCost,
               "cycles that a load waits whose result the next instruction uses"),
      [](auto& core) -> auto& { return core.load_use_stall; });
  table.add_of_cores(
      section,
      optional(choice(key("code"), {work::kCompiledFor.begin(), work::kCompiledFor.end()},
                      "table of compiled code that the cores execute: platform_models/code/")),
      [](auto& core) -> auto& { return core.code; });
  for (const work::OpInfo& info : work::kOps) add_operation(table, section, info);
}

void add_cores_of_cluster(Table& table) {
  table.add(
      quantity("cluster.clock", kFrequency, kMinClock, kMaxClock,
               "clock of the cluster's cores, L1, DMA and event unit"),
      [](auto& chip) -> auto& { return chip.cluster.clock; });
  table.add(
      quantity("cluster.workers", kCores, 1, kMaxParts,
               "number of worker cores, without the master"),
      [](auto& chip) -> auto& { return chip.cluster.workers; });
  table.add(
      quantity("cluster.max_workers", kCores, 1, kMaxParts,
               "largest number of workers that the event unit can serve"),
      [](auto& chip) -> auto& { return chip.cluster.max_workers; });
  add_core(table, {"cluster.core", true, false});
}

void add_fpu(Table& table) {
  table.add(
      quantity("cluster.fpu.units", kUnits, 0, kMaxParts,
               "number of floating-point units that the cluster's cores share"),
      [](auto& chip) -> auto& { return chip.cluster.fpu.units; });
  table.add(
      choice("cluster.fpu.mapping", {"fixed", "dynamic"},
             "mapping of cores to floating-point units: fixed, core c uses unit c mod units; "
             "dynamic, any"),
      [](auto& chip) -> auto& { return chip.cluster.fpu.mapping; });
  table.add(
      quantity("cluster.fpu.dividers", kUnits, 0, kMaxParts,
               "number of divide and square-root units that the cluster's cores share"),
      [](auto& chip) -> auto& { return chip.cluster.fpu.dividers; });
  table.add(
      quantity("cluster.fpu.int64_units", kUnits, 0, kMaxParts,
               "number of units for 64-bit integers that the cluster's cores share, mapped as the "
               "others"),
      [](auto& chip) -> auto& { return chip.cluster.fpu.int64_units; });
  table.add(
      optional(quantity(
          "cluster.fpu.collisions", kRatio, 0, 10,
          "ratio of collisions at shared units, dividers and accelerators to those of requests at "
          "random phases; 0 if not given: cores find their turns")),
      [](auto& chip) -> auto& { return chip.cluster.fpu.collisions; });
}

/// Sizes and times that every instruction cache has.
template <class Caches>
void add_instruction_cache(Table& table, const std::string& path, const std::string& whose,
                           Caches caches) {
  table.add(
      quantity(path + ".line", kSize, 1, 1024,
               "line of the instruction caches: bytes of code fetched at once"),
      [caches](auto& chip) -> auto& { return caches(chip).line; });
  table.add(
      quantity(path + ".size", kSize, 0, kMaxSize,
               "size of the private instruction cache of " + whose),
      [caches](auto& chip) -> auto& { return caches(chip).worker; });
  table.add(
      quantity(path + ".refill_width", kRate, kLeastTime, 1024,
               "bytes of a line that come from L2 per cycle"),
      [caches](auto& chip) -> auto& { return caches(chip).refill_width; });
  table.add(
      optional(quantity(
          path + ".ways", kUnits, 1, kMaxParts,
          "associativity of these caches: lines of a set, replaced at random; 4 if not given")),
      [caches](auto& chip) -> auto& { return caches(chip).ways; });
}

/// Of both: the compiler is the same.
template <class Caches>
void add_code_size(Table& table, const std::string& path, Caches caches) {
  table.add(
      optional(quantity(path + ".code_size", kRatio, 0.1, 10,
                        "ratio of the bytes of code to those that were measured; 1 if not given")),
      [caches](auto& chip) -> auto& { return caches(chip).code_size; });
}

void add_code_of_cluster(Table& table) {
  const auto caches = [](auto& chip) -> auto& { return chip.cluster.icache; };
  const std::string path = "cluster.icache";
  add_instruction_cache(table, path, "a worker; 0 for none", caches);
  table.add(
      quantity(path + ".master_size", kSize, 0, kMaxSize,
               "size of the private instruction cache of the master"),
      [](auto& chip) -> auto& { return chip.cluster.icache.master; });
  table.add(
      quantity(path + ".shared_size", kSize, 1, kMaxSize,
               "size of the instruction cache that the cores share"),
      [](auto& chip) -> auto& { return chip.cluster.icache.shared; });
  table.add(
      quantity(path + ".shared_banks", kBanks, 1, kMaxParts,
               "lines that the shared instruction cache can deliver in a cycle"),
      [](auto& chip) -> auto& { return chip.cluster.icache.shared_banks; });
  table.add(
      quantity(path + ".shared_hit", kCycles, 0, kMaxCost,
               "cycles waited for a line that the private cache lacks and the shared one has"),
      [](auto& chip) -> auto& { return chip.cluster.icache.shared_hit; });
  table.add(
      quantity(path + ".shared_miss", kCycles, kLeastTime, kMaxCost,
               "cycles waited until a line begins to come from L2"),
      [](auto& chip) -> auto& { return chip.cluster.icache.shared_miss; });
  table.add(
      quantity(path + ".refills", kUnits, kLeastTime, kMaxParts,
               "lines that the shared instruction cache can await from L2 at once"),
      [](auto& chip) -> auto& { return chip.cluster.icache.refills; });
  add_code_size(table, path, caches);
}

/// The controller has no shared cache in front of L2.
void add_code_of_controller(Table& table) {
  add_instruction_cache(
      table, "controller.icache", "the controller",
      [](auto& chip) -> auto& { return chip.controller.icache; });
  table.add(
      quantity("controller.icache.miss", kCycles, kLeastTime, kMaxCost,
               "cycles that the controller waits until a line begins to come from L2"),
      [](auto& chip) -> auto& { return chip.controller.icache.shared_miss; });
  add_code_size(
      table, "controller.icache", [](auto& chip) -> auto& { return chip.controller.icache; });
}

void add_l1_and_dma(Table& table) {
  table.add(
      quantity("cluster.l1.size", kSize, 1, kMaxSize, "size of the cluster's L1"),
      [](auto& chip) -> auto& { return chip.cluster.l1.size; });
  table.add(
      quantity("cluster.l1.banks", kBanks, 1, kMaxParts,
               "number of word-interleaved banks of L1, a power of two"),
      [](auto& chip) -> auto& { return chip.cluster.l1.banks; });
  table.add(
      optional(quantity("cluster.l1.stream_conflicts", kRatio, 0, 10,
                        "ratio of bank conflicts among the cores' streams to those of as many "
                        "scattered accesses; 0 if not given: streams walk in step")),
      [](auto& chip) -> auto& { return chip.cluster.l1.stream_conflicts; });
  table.add(
      quantity("cluster.dma.programming", kCycles, 0, kMaxCost,
               "cycles of the programming core until a transfer begins"),
      [](auto& chip) -> auto& { return chip.cluster.dma.programming; });
  table.add(
      quantity("cluster.dma.first_data", kCycles, 0, kMaxCost,
               "cycles from the start of a transfer until its first data arrive"),
      [](auto& chip) -> auto& { return chip.cluster.dma.first_data; });
  table.add(
      quantity("cluster.dma.bytes_per_cycle", kRate, kLeastTime, 1e6,
               "bytes of a transfer per cluster cycle"),
      [](auto& chip) -> auto& { return chip.cluster.dma.bytes_per_cycle; });
  table.add(
      quantity("cluster.dma.completion", kCycles, 0, kMaxCost,
               "cycles from the last data until the waiting core goes on"),
      [](auto& chip) -> auto& { return chip.cluster.dma.completion; });
  table.add(
      optional(quantity("cluster.dma.commands", kUnits, 1, kMaxParts,
                        "transfers under way, at most; the programming core waits for room")),
      [](auto& chip) -> auto& { return chip.cluster.dma.commands; });
  table.add(
      optional(quantity("cluster.dma.call", kCycles, 0, kMaxCost,
                        "cycles of the programming core once a transfer has begun, the rest of the "
                        "call of the API; 0 if not given")),
      [](auto& chip) -> auto& { return chip.cluster.dma.call; });
}

void add_events(Table& table) {
  table.add(
      quantity("cluster.events.fork_master", kCycles, 0, kMaxCost,
               "cycles of the master per team fork"),
      [](auto& chip) -> auto& { return chip.cluster.events.fork_master; });
  table.add(
      quantity("cluster.events.fork_worker", kCycles, 0, kMaxCost,
               "cycles from the dispatch until a worker begins its share"),
      [](auto& chip) -> auto& { return chip.cluster.events.fork_worker; });
  table.add(
      quantity("cluster.events.barrier", kCycles, 0, kMaxCost,
               "cycles from the last arrival until everyone goes on"),
      [](auto& chip) -> auto& { return chip.cluster.events.barrier; });
  table.add(
      quantity("cluster.events.offload", kCycles, 0, 1e7,
               "controller cycles between controller and cluster task, one way"),
      [](auto& chip) -> auto& { return chip.cluster.events.offload; });
  table.add(
      optional(quantity("cluster.events.fork_again", kRatio, 0, 1,
                        "share of fork_master and fork_worker that a fork right after another one "
                        "takes; 1 if not given")),
      [](auto& chip) -> auto& { return chip.cluster.events.fork_again; });
}

void add_controller(Table& table) {
  table.add(
      quantity("controller.clock", kFrequency, kMinClock, kMaxClock,
               "clock of the fabric controller"),
      [](auto& chip) -> auto& { return chip.controller.clock; });
  table.add(
      optional(choice("controller.runs_on", {"own_core", "cluster_core"},
                      "core that does the controller's work: one of its own, or in turns with "
                      "the cluster's work on the only core of the chip")),
      [](auto& chip) -> auto& { return chip.controller.shares_core; });
  add_core(table, {"controller.core", false, true});
}

/// A chip need not have external memory.
void add_external_memory(Table& table) {
  table.add(
      optional(quantity("controller.external.size", kSize, 0, kMaxSize,
                        "size of external memory, which holds what L2 has no room for")),
      [](auto& chip) -> auto& { return chip.controller.external.size; });
  table.add(
      optional(quantity("controller.external.latency", kTime, 0, 1,
                        "time of a transfer from or to external memory without its data")),
      [](auto& chip) -> auto& { return chip.controller.external.latency_seconds; });
  table.add(
      optional(quantity("controller.external.rate", kThroughput, 0, 1e12,
                        "bandwidth of transfers from and to external memory")),
      [](auto& chip) -> auto& { return chip.controller.external.bytes_per_second; });
  table.add(
      optional(quantity("controller.external.burst", kSize, 0, 1e6,
                        "smallest amount that a transfer from or to external memory moves")),
      [](auto& chip) -> auto& { return chip.controller.external.burst; });
}

void add_l2(Table& table) {
  table.add(
      quantity("l2.size", kSize, 1, kMaxSize, "size of L2"),
      [](auto& chip) -> auto& { return chip.l2.size; });
}

}  // namespace

std::vector<Field> all_fields() {
  Table table;
  add_core(table, {"isa", true, true});
  add_cores_of_cluster(table);
  add_fpu(table);
  add_code_of_cluster(table);
  add_l1_and_dma(table);
  add_events(table);
  table.append(accelerator_fields("cluster"));
  add_controller(table);
  add_code_of_controller(table);
  add_external_memory(table);
  table.append(accelerator_fields("controller"));
  add_l2(table);
  std::vector<Field> fields = table.take();
  for (std::vector<Field>& part : std::array{energy_fields(), area_fields()})
    for (Field& field : part) fields.push_back(std::move(field));
  return fields;
}

}  // namespace leviosim::platform
