// A small chip with round numbers, so that tests can state closed formulas.
#pragma once

#include "sim/chip/config.h"
#include "sim/work/op.h"

namespace leviosim::sim {

inline CoreConfig unit_cost_core() {
  CoreConfig core;
  for (const work::OpInfo& info : work::kOps) core.ops[work::index(info.op)] = {1, 0, Unit::Core};
  for (const work::Op op : {work::Op::F32Add, work::Op::F32Mul, work::Op::F32Fma})
    core.ops[work::index(op)].unit = Unit::Fpu;
  for (const work::Op op : {work::Op::F32Div, work::Op::F32Sqrt})
    core.ops[work::index(op)] = {1, 13, Unit::Divider, 14};
  core.ops[work::index(work::Op::F16Div)] = {1, 9, Unit::Divider, 10};
  core.ops[work::index(work::Op::F16Op)].unit = Unit::Fpu;
  for (const work::Op op : {work::Op::Int64Add, work::Op::Int64Mul, work::Op::Int64Mac})
    core.ops[work::index(op)].unit = Unit::Int64;
  for (const work::Op op : {work::Op::LoadShared, work::Op::StoreShared})
    core.ops[work::index(op)].unit = Unit::Bank;
  return core;
}

/// Nine cores on four floating-point units and one divider of 14 cycles, as in
/// FACTS.md#floating-point-units.
inline ClusterConfig test_cluster() {
  ClusterConfig c;
  c.clock = Hertz(370'000'000);
  c.workers = 8;
  c.max_workers = 8;
  c.core = unit_cost_core();
  c.fpu = {4, FpuMapping::Fixed, 1, 4};
  c.l1 = {Bytes(128 * 1024), 16};
  c.dma = {25, 16, 8, 8};
  c.events = {40, 20, 10, 300};
  return c;
}

inline ChipConfig test_chip() {
  return {"test", test_cluster(), {Hertz(370'000'000), unit_cost_core(), {}}, {Bytes(1'600'000)}};
}

/// So many integer operations.
inline work::Counts alu(std::uint64_t n) {
  work::Counts counts;
  counts[work::Op::IntAlu] = n;
  return counts;
}

}  // namespace leviosim::sim
