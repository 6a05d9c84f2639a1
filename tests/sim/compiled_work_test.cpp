// Measured means of functions: their sums over a work segment's visits, and what they do to its
// price.
#include "sim/work/compiled_work.h"

#include <gtest/gtest.h>

#include "sim/chip/cost.h"
#include "sim/chip/work_sum.h"
#include "sim/work/code_tracker.h"
#include "sim/work/op.h"

namespace leviosim::sim {
namespace {

using work::CodeMap;
using work::Counts;
using work::Op;

/// Of a visit, in whole instructions.
work::CompiledSets of_visit(std::uint64_t executed, std::uint64_t priced, std::uint64_t loads,
                            std::uint64_t used_at_once,
                            work::CompiledFor set = work::CompiledFor::Rv32imfc) {
  work::CompiledWork work{executed, priced, loads, used_at_once, 0, 0};
  for (std::uint64_t& part : work) part *= static_cast<std::uint64_t>(work::kCompiledUnit);
  work::CompiledSets sets{};
  work::set_compiled(sets, set, work);
  return sets;
}

TEST(CompiledWork, IsTheSumOverVisitsOfFunctionsWhateverTheOrder) {
  CodeMap map;
  map.add("outer", "", 64, 0, of_visit(10, 8, 4, 1));
  map.add("outer", "inner", 32);
  map.add("inner", "", 32, 0, of_visit(7, 9, 2, 2));
  work::CodeTracker tracker(map);
  work::take_tally();
  work::current_code = &tracker;
  constexpr std::uint64_t kOuter = 3, kInner = 50;
  for (std::uint64_t o = 0; o < kOuter; ++o) {
    work::code_events.enter("outer");
    for (std::uint64_t i = 0; i < kInner; ++i) {
      work::code_events.enter("inner");
      work::code_events.leave();
    }
    work::code_events.leave();
  }
  work::code_events.enter("unknown");
  work::code_events.leave();
  work::fetch_code();
  work::current_code = nullptr;
  const std::uint64_t n = kOuter * kInner;
  EXPECT_EQ(work::take_tally().compiled, of_visit(10 * kOuter + 7 * n, 8 * kOuter + 9 * n,
                                                  4 * kOuter + 2 * n, 1 * kOuter + 2 * n));
}

CoreConfig core() {
  CoreConfig core;
  core.ops[work::index(Op::IntAlu)] = {.issue = 1};
  core.ops[work::index(Op::LoadStream)] = {.issue = 1};
  core.ops[work::index(Op::F64Mul)] = {.issue = 200, .routine = true};
  core.unmeasured_instructions = 0.9;
  core.load_use_fraction = 0.25;
  core.load_use_stall = 2;
  return core;
}

Counts counted() {
  Counts counts;
  counts[Op::IntAlu] = 600;
  counts[Op::LoadStream] = 400;
  counts[Op::F64Mul] = 3;
  return counts;
}

TEST(CompiledWork, ScalesInstructionsAndLoadStallsButNoRoutines) {
  Counts counts = counted();
  counts.compiled = of_visit(120, 100, 50, 30);
  const LoneCycles alone = demand_of(counts, core()).alone;
  EXPECT_DOUBLE_EQ(alone[Mechanism::Issue], 1000 * 1.2 + 3 * 200);
  EXPECT_DOUBLE_EQ(alone[Mechanism::LoadUse], 10 * 30 * 2);
}

/// A visit that executes 10 loads, all used at once, has 10 waits, whether 400 loads were counted
/// (the compiler keeps values in registers) or 2 (it spills), and without loads it has none.
TEST(CompiledWork, LoadsWaitAsOftenAsTheyWereExecutedHoweverManyWereCounted) {
  for (const std::uint64_t counted_loads : {400u, 2u}) {
    Counts counts;
    counts[Op::LoadStream] = counted_loads;
    counts[Op::IntAlu] = 1000 - counted_loads;
    counts.compiled = of_visit(700, 1000, 10, 10);
    EXPECT_DOUBLE_EQ(demand_of(counts, core()).alone[Mechanism::LoadUse], 10 * 2);
    EXPECT_DOUBLE_EQ(WorkSum(counts, core().code).cost(core())[Mechanism::LoadUse], 10 * 2);
    counts.compiled = of_visit(700, 1000, 0, 0);
    EXPECT_EQ(demand_of(counts, core()).alone[Mechanism::LoadUse], 0);
  }
}

TEST(CompiledWork, OfAnotherInstructionSetChangesItsCoresOnly) {
  Counts counts = counted();
  counts.compiled = of_visit(120, 100, 50, 30, work::CompiledFor::Thumb2);
  CoreConfig arm = core();
  arm.code = work::CompiledFor::Thumb2;
  const LoneCycles alone = demand_of(counts, arm).alone;
  EXPECT_DOUBLE_EQ(alone[Mechanism::Issue], 1000 * 1.2 + 3 * 200);
  EXPECT_DOUBLE_EQ(alone[Mechanism::LoadUse], 10 * 30 * 2);
  EXPECT_DOUBLE_EQ(demand_of(counts, core()).alone[Mechanism::Issue],
                   demand_of(counted(), core()).alone[Mechanism::Issue]);
  EXPECT_DOUBLE_EQ(WorkSum(counts, arm.code).cost(arm)[Mechanism::Issue], alone[Mechanism::Issue]);
}

/// Half of the repetitions are left of loops that the compiler writes out, and all of the rest.
TEST(CompiledWork, LoopsHaveARatioOfTheirOwn) {
  Counts counts;
  counts[Op::IntAlu] = 600;
  counts[Op::LoopIteration] = 400;
  counts[Op::LoopJump] = 10;
  counts.compiled = of_visit(100, 120, 50, 0);
  counts.compiled[static_cast<std::size_t>(work::Compiled::ExecutedLoops)] = 20 * 16;
  counts.compiled[static_cast<std::size_t>(work::Compiled::PricedLoops)] = 40 * 16;
  CoreConfig with_hardware_loops = core();
  with_hardware_loops.ops[work::index(Op::LoopJump)] = {.issue = 2, .stall = 3};
  const LoneCycles alone = demand_of(counts, with_hardware_loops).alone;
  EXPECT_DOUBLE_EQ(alone[Mechanism::Issue], 600 * 1.0 + 10 * 2 * 0.5);
  EXPECT_DOUBLE_EQ(alone[Mechanism::Control],
                   10 * 3 * 0.5);  // what is written out has no branch to wait for
  CoreConfig without = core();
  without.ops[work::index(Op::LoopIteration)] = {.issue = 2};
  EXPECT_DOUBLE_EQ(demand_of(counts, without).alone[Mechanism::Issue], 600 * 1.0 + 400 * 2 * 0.5);
}

TEST(CompiledWork, OfCodeThatWasNotMeasuredIsWhatThePlatformSays) {
  const LoneCycles alone = demand_of(counted(), core()).alone;
  EXPECT_DOUBLE_EQ(alone[Mechanism::Issue], 1000 * 0.9 + 3 * 200);
  EXPECT_DOUBLE_EQ(alone[Mechanism::LoadUse], 400 * 0.25 * 2);
}

TEST(CompiledWork, OfTwoSegmentsTogetherIsTheirSum) {
  Counts a = counted(), b = counted();
  a.compiled = of_visit(3000, 1000, 10, 0);
  b.compiled = of_visit(1000, 1000, 10, 10);
  EXPECT_DOUBLE_EQ(demand_of(a + b, core()).alone[Mechanism::LoadUse], 10 * 2);
}

}  // namespace
}  // namespace leviosim::sim
