// The numbers of GAP9 against published costs, and the completeness of the file.
#include <bit>
#include <set>

#include "sim/chip/cost.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

using work::Counts;
using work::Op;

double cycles(const Counts& counts, const sim::CoreConfig& core) {
  return sim::demand_of(counts, core).cycles();
}

Counts once(Op op) {
  Counts counts;
  counts[op] = 1;
  return counts;
}

Counts division_by(std::uint32_t divisor) {
  Counts counts = once(Op::IntDiv);
  counts[Op::IntDivBits] = static_cast<std::uint64_t>(std::countl_zero(divisor));
  return counts;
}

/// A core whose compiler emits what the table says and schedules all loads well.
sim::CoreConfig ideal_core() {
  sim::CoreConfig core = load_platform("gap9").cluster.core;
  core.load_use_fraction = 0;
  return core;
}

TEST(Gap9, StructureOfTheChip) {
  const sim::ChipConfig chip = load_platform("gap9");
  EXPECT_EQ(chip.name, "GAP9");
  EXPECT_EQ(chip.cluster.clock.count(), 370'000'000);
  EXPECT_EQ(chip.controller.clock.count(), 370'000'000);
  EXPECT_EQ(chip.cluster.workers, 8);
  EXPECT_EQ(chip.cluster.fpu.units, 4);
  EXPECT_EQ(chip.cluster.fpu.mapping, sim::FpuMapping::Fixed);
  EXPECT_EQ(chip.cluster.fpu.dividers, 1);
  EXPECT_EQ(chip.cluster.fpu.int64_units, 4);
  EXPECT_EQ(chip.cluster.l1.size.count(), 131072);
  EXPECT_EQ(chip.cluster.l1.banks, 16);
  EXPECT_EQ(chip.l2.size.count(), 0x190000);
}

// FACTS.md#core-measurements: cycles of single instructions measured on the core's RTL.
TEST(Gap9, InstructionsCostWhatTheRtlMeasures) {
  const sim::CoreConfig core = ideal_core();
  EXPECT_EQ(cycles(division_by(0x9876), core), 19);
  EXPECT_EQ(cycles(division_by(1), core), 34);
  EXPECT_EQ(cycles(division_by(0x40000000), core), 4);
  EXPECT_EQ(cycles(division_by(0), core), 35);
  EXPECT_EQ(cycles(once(Op::BranchTaken), core), 3);
  EXPECT_EQ(cycles(once(Op::BranchNotTaken), core), 1);
  EXPECT_EQ(cycles(once(Op::LoadStream), core), 1);
  EXPECT_EQ(cycles(once(Op::LoadStream) + once(Op::Straddle), core), 2);
  EXPECT_EQ(cycles(once(Op::IntMul), core), 1);
  sim::CoreConfig dependent = core;
  dependent.load_use_fraction = 1;
  EXPECT_EQ(cycles(once(Op::LoadStream) + once(Op::IntAlu), dependent), 3);
}

// What a routine costs was counted with its moves and spills.
TEST(Gap9, FactorsOnInstructionsSpareLibraryRoutines) {
  sim::CoreConfig core = ideal_core();
  core.unmeasured_instructions = 1.5;
  EXPECT_EQ(cycles(once(Op::F64Compare), core), 24 + 9);
  EXPECT_EQ(cycles(once(Op::IntAlu), core), 1.5);
}

// FACTS.md#calibration-table: one core of the vendor's calibration table, without its noise of
// 0.02.
TEST(Gap9, FloatingPointCostsWhatTheCalibrationMeasures) {
  const sim::CoreConfig core = ideal_core();
  for (const Op op : {Op::F32Add, Op::F32Mul, Op::F32Fma, Op::F32Sign, Op::F32Convert}) {
    EXPECT_EQ(cycles(once(op), core), 1);
    EXPECT_EQ(core[op].unit, sim::Unit::Fpu);
    EXPECT_EQ(core[op].busy, 1);
  }
  for (const auto& [op, busy] : {std::pair{Op::F32Div, 14}, {Op::F32Sqrt, 14}, {Op::F16Div, 10}}) {
    EXPECT_EQ(cycles(once(op), core), busy);
    EXPECT_EQ(core[op].unit, sim::Unit::Divider);
    EXPECT_EQ(core[op].busy, busy);
  }
  for (const Op op : {Op::Int64Add, Op::Int64Mul, Op::Int64Mac}) {
    EXPECT_EQ(cycles(once(op), core), 1);
    EXPECT_EQ(core[op].unit, sim::Unit::Int64);
  }
}

TEST(Gap9, ControllerDiffersOnlyInItsDivider) {
  const sim::ChipConfig chip = load_platform("gap9");
  for (const work::OpInfo& info : work::kOps) {
    const bool own = info.op == Op::F32Div || info.op == Op::F32Sqrt;
    const sim::OpCost& cluster = chip.cluster.core[info.op];
    const sim::OpCost& controller = chip.controller.core[info.op];
    EXPECT_EQ(controller.issue, cluster.issue) << info.name;
    EXPECT_EQ(controller.stall, own ? 14 : cluster.stall) << info.name;
    EXPECT_EQ(controller.unit, cluster.unit) << info.name;
  }
}

// FACTS.md#synchronisation and FACTS.md#cluster-dma.
TEST(Gap9, ForksAndTransfersAreWithinTheirBounds) {
  const sim::ClusterConfig cluster = load_platform("gap9").cluster;
  EXPECT_EQ(cluster.events.fork_master + cluster.events.fork_worker + cluster.events.barrier, 33);
  EXPECT_EQ(cluster.events.offload, 300);
  const double image = 160 * 120 / cluster.dma.bytes_per_cycle + cluster.dma.programming +
                       cluster.dma.first_data + cluster.dma.completion;
  EXPECT_NEAR(image, 2450, 15);
}

// The bounds of the sum are those that FACTS.md derives; the parts share them.
TEST(Gap9, RangesOfAForkAddUpToItsBounds) {
  double low = 0;
  double high = 0;
  for (const Parameter& p : resolve_platform("gap9").parameters) {
    if (p.path != "cluster.events.fork_master" && p.path != "cluster.events.fork_worker" &&
        p.path != "cluster.events.barrier")
      continue;
    ASSERT_TRUE(p.range);
    low += p.range->low;
    high += p.range->high;
  }
  EXPECT_EQ(low, 23);
  EXPECT_EQ(high, 190);
}

TEST(Gap9, GivesEveryRequiredParameterAndNothingElse) {
  const Schema schema;
  std::set<std::string> given;
  for (const Parameter& p : resolve_platform("gap9").parameters) {
    EXPECT_TRUE(given.insert(p.path).second) << p.path;
    EXPECT_NE(schema.find(p.path), Schema::kNone) << p.path;
  }
  for (const Field& field : schema.fields())
    EXPECT_EQ(given.count(field.path) == 1 || !field.required, true) << field.path;
}

TEST(Gap9, EveryUncertainNumberHasARange) {
  for (const Parameter& p : resolve_platform("gap9").parameters) {
    EXPECT_FALSE(p.source.empty()) << p.path;
    EXPECT_FALSE(p.description.empty()) << p.path;
    EXPECT_FALSE(p.overridden) << p.path;
    if (p.unit.empty() || p.confidence == "high") continue;
    EXPECT_TRUE(p.range) << p.path << " has confidence " << p.confidence << " and no range";
  }
}

TEST(Gap9, BothEndsOfEveryRangeCanBeRun) {
  for (const Parameter& p : resolve_platform("gap9").parameters) {
    if (!p.range) continue;
    for (const double end : {p.range->low, p.range->high}) {
      const std::string override = p.path + "=" + std::to_string(end) + p.unit;
      EXPECT_NO_THROW(load_platform("gap9", {override})) << override;
    }
  }
}

}  // namespace
}  // namespace leviosim::platform
