// What must hold when the hardware changes, on every chip: what is faster, larger or more makes no
// job slower; what has nothing to do with time does not change it.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "sim/work/op.h"
#include "tests/platform_models/timing_jobs.h"

namespace leviosim::platform::testing {
namespace {

Job mixed(int workers) {
  Segment busy = some_work(20, 2);
  busy[Op::F32Div] += 500;
  busy[Op::F32Fma] += 5000;
  busy[Op::LoadIndexed] += 3000;
  return job_of({serial(some_work(30)), transfer(5000, true), transfer(200, true),
                 team(workers, busy), wait_for(0), wait_for(1), transfer(300),
                 team(workers, some_work(10, 3))});
}

/// A change that makes no job slower.
struct Improvement {
  const char* name;
  std::function<void(ChipConfig&)> improve;
};

std::vector<Improvement> improvements() {
  std::vector<Improvement> list;
  const auto add = [&](const char* name, auto improve) { list.push_back({name, improve}); };
  add("twice the floating-point units", [](ChipConfig& c) { c.cluster.fpu.units *= 2; });
  add("any floating-point unit serves any core",
      [](ChipConfig& c) { c.cluster.fpu.mapping = sim::FpuMapping::Dynamic; });
  add("twice the dividers", [](ChipConfig& c) { c.cluster.fpu.dividers *= 2; });
  add("twice the 64-bit units", [](ChipConfig& c) { c.cluster.fpu.int64_units *= 2; });
  add("twice the banks", [](ChipConfig& c) { c.cluster.l1.banks *= 2; });
  add("twice the banks of the instruction cache",
      [](ChipConfig& c) { c.cluster.icache.shared_banks *= 2; });
  add("a larger shared instruction cache",
      [](ChipConfig& c) { c.cluster.icache.shared = 2 * c.cluster.icache.shared; });
  add("larger private instruction caches",
      [](ChipConfig& c) { c.cluster.icache.worker = 2 * c.cluster.icache.worker; });
  add("a larger instruction cache of the master",
      [](ChipConfig& c) { c.cluster.icache.master = 2 * c.cluster.icache.master; });
  add("faster hits in the shared instruction cache",
      [](ChipConfig& c) { c.cluster.icache.shared_hit /= 2; });
  add("smaller code", [](ChipConfig& c) { c.cluster.icache.code_size *= 0.8; });
  add("faster refills", [](ChipConfig& c) { c.cluster.icache.shared_miss *= 0.75; });
  add("wider refills", [](ChipConfig& c) { c.cluster.icache.refill_width *= 2; });
  add("more refills at once", [](ChipConfig& c) { c.cluster.icache.refills *= 2; });
  add("a wider DMA", [](ChipConfig& c) { c.cluster.dma.bytes_per_cycle *= 2; });
  add("earlier first data", [](ChipConfig& c) { c.cluster.dma.first_data /= 2; });
  add("a DMA that is programmed faster", [](ChipConfig& c) { c.cluster.dma.programming /= 2; });
  add("a DMA that tells faster", [](ChipConfig& c) { c.cluster.dma.completion /= 2; });
  add("room for any number of transfers", [](ChipConfig& c) { c.cluster.dma.commands = 0; });
  add("faster forks of the master", [](ChipConfig& c) { c.cluster.events.fork_master /= 2; });
  add("faster forks of the workers", [](ChipConfig& c) { c.cluster.events.fork_worker /= 2; });
  add("faster barriers", [](ChipConfig& c) { c.cluster.events.barrier /= 2; });
  add("fewer instructions", [](ChipConfig& c) { c.cluster.core.unmeasured_instructions *= 0.9; });
  add("loads used later", [](ChipConfig& c) { c.cluster.core.load_use_fraction *= 0.5; });
  add("loads that answer earlier", [](ChipConfig& c) { c.cluster.core.load_use_stall *= 0.5; });
  for (const work::OpInfo& info : work::kOps)
    list.push_back({info.name.data(), [op = info.op](ChipConfig& c) {
                      c.cluster.core.ops[work::index(op)].stall *= 0.5;
                    }});
  return list;
}

class Hardware : public ::testing::TestWithParam<std::string> {
 protected:
  ChipConfig chip() const { return load_platform(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Chips, Hardware,
                         ::testing::Values("gap9", "gap8", "cortex-m4f", "cortex-m7", "arm1176"),
                         [](const auto& chosen) {
                           std::string name = chosen.param;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST_P(Hardware, BetterHardwareIsNeverSlower) {
  const ChipConfig before = chip();
  const int workers = before.cluster.workers;
  const Job job = mixed(workers);
  const std::int64_t now = cycles(before, workers, job);
  for (const Improvement& improvement : improvements()) {
    ChipConfig better = before;
    improvement.improve(better);
    // Ends of shares fall on clock edges.
    EXPECT_LE(cycles(better, workers, job), now + 2) << improvement.name;
  }
}

TEST_P(Hardware, CyclesDoNotDependOnTheVoltage) {
  ChipConfig low = chip();
  low.supply = {};
  low.energy = {};
  const int workers = low.cluster.workers;
  EXPECT_EQ(cycles(low, workers, mixed(workers)), cycles(chip(), workers, mixed(workers)));
}

TEST_P(Hardware, ClocksAtHalfSpeedTakeAsManyCycles) {
  ChipConfig slow = chip();
  slow.cluster.clock = Hertz(slow.cluster.clock.count() / 2);
  slow.controller.clock = Hertz(slow.controller.clock.count() / 2);
  const int workers = slow.cluster.workers;
  const sim::JobTiming before = timing_of(chip(), workers, mixed(workers));
  const sim::JobTiming after = timing_of(slow, workers, mixed(workers));
  EXPECT_EQ(sum_of_cycles(after), sum_of_cycles(before));
}

TEST_P(Hardware, ASlowerSocIsNeverFasterForTheCluster) {
  ChipConfig slow = chip();
  slow.controller.clock = Hertz(slow.controller.clock.count() / 2);
  const int workers = slow.cluster.workers;
  EXPECT_GE(cycles(slow, workers, mixed(workers)), cycles(chip(), workers, mixed(workers)));
}

TEST_P(Hardware, ASlowerSocDoesNotMatterWithoutL2) {
  ChipConfig slow = chip();
  slow.controller.clock = Hertz(slow.controller.clock.count() / 2);
  const int workers = slow.cluster.workers;
  const Job job = job_of({serial(only(Op::F32Fma, 1000)), team(workers, only(Op::IntAlu, 5000))});
  EXPECT_EQ(cycles(slow, workers, job), cycles(chip(), workers, job));
}

TEST_P(Hardware, TheClusterDoesNotMatterToTheController) {
  ChipConfig other = chip();
  other.cluster.fpu.units = 1;
  other.cluster.l1.banks = 2;
  other.cluster.core.unmeasured_instructions = 3;
  const Job job = job_of({serial(some_work(100))});
  EXPECT_EQ(sum_of_cycles(controlled(other, job)), sum_of_cycles(controlled(chip(), job)));
}

TEST_P(Hardware, TheControllerDoesNotMatterToTheCluster) {
  ChipConfig other = chip();
  other.controller.core.unmeasured_instructions = 3;
  other.controller.icache.worker = Bytes(0);
  const int workers = other.cluster.workers;
  EXPECT_EQ(cycles(other, workers, mixed(workers)), cycles(chip(), workers, mixed(workers)));
}

TEST_P(Hardware, SizesOfMemoriesDoNotMatter) {
  ChipConfig large = chip();
  large.cluster.l1.size = 2 * large.cluster.l1.size;
  large.l2.size = 2 * large.l2.size;
  const int workers = large.cluster.workers;
  EXPECT_EQ(cycles(large, workers, mixed(workers)), cycles(chip(), workers, mixed(workers)));
}

TEST_P(Hardware, AcceleratorsThatNobodyCallsDoNotMatter) {
  ChipConfig other = chip();
  for (sim::AcceleratorConfig& accelerator : other.cluster.accelerators)
    accelerator = {2, 10, 5, 1, 0.5};
  const int workers = other.cluster.workers;
  EXPECT_EQ(cycles(other, workers, mixed(workers)), cycles(chip(), workers, mixed(workers)));
}

TEST_P(Hardware, MoreWorkersThanSharesDoNotMatterToTheWork) {
  const ChipConfig all = chip();
  if (all.cluster.workers < 2) return;
  const std::vector<Segment> two = {plain_work(50), plain_work(50)};
  const auto useful = [&](int workers) {
    return timing_of(all, workers, job_of({fork(two)})).stages[0].account.team.alone();
  };
  EXPECT_NEAR(useful(2), useful(all.cluster.workers), 1e-6);
}

TEST_P(Hardware, ShorterRefillsAndLargerCachesNeverMakeATeamGainMoreThanItsCores) {
  for (const double miss : {5.0, 14.0, 26.0, 60.0})
    for (const int kib : {1, 4, 16}) {
      ChipConfig c = chip();
      c.cluster.icache.shared_miss = miss;
      c.cluster.icache.shared = Bytes(1024 * kib);
      const int workers = c.cluster.workers;
      const auto share = [](int scale) {
        return some_work(static_cast<std::uint64_t>(100 * scale), 1);
      };
      Segment all = share(workers);
      all.code[work::kNeverFetched] *= static_cast<std::uint64_t>(workers);
      const double one = static_cast<double>(cycles(c, 1, {fork({all})}));
      const double many = static_cast<double>(cycles(c, workers, {team(workers, share(1))}));
      EXPECT_LE(one / many, workers * 1.0001) << miss << " cycles, " << kib << " KiB";
    }
}

TEST_P(Hardware, MoreChanceCollisionsAreNeverFaster) {
  const int workers = chip().cluster.workers;
  const auto with = [&](double collisions, double conflicts) {
    ChipConfig c = chip();
    c.cluster.fpu.collisions = collisions;
    c.cluster.l1.stream_conflicts = conflicts;
    return cycles(c, workers, mixed(workers));
  };
  for (const double less : {0.0, 0.4, 0.8, 1.2}) {
    EXPECT_LE(with(less, 0.5), with(less + 0.4, 0.5) + 2) << less;
    EXPECT_LE(with(0.5, less), with(0.5, less + 0.4) + 2) << less;
  }
}

TEST_P(Hardware, LoopsThatHardwareRepeatsAreNeverSlower) {
  ChipConfig without = chip();
  without.cluster.core.ops[work::index(Op::LoopJump)] = {2, 2};
  ChipConfig with = chip();
  with.cluster.core.ops[work::index(Op::LoopJump)] = {};
  const int workers = with.cluster.workers;
  EXPECT_LE(cycles(with, workers, mixed(workers)), cycles(without, workers, mixed(workers)));
}

}  // namespace
}  // namespace leviosim::platform::testing
