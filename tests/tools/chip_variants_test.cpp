// Variants of GAP9 that `-p` asks for: 1 to 16 cores, 1 to 16 floating-point units and how they are
// mapped, 1 to 4 dividers, 64 to 512 kB of L1, 4 to 16 B/cycle of DMA. Each runs and changes the
// time in the right direction, or is refused with the reason.
#include <gtest/gtest.h>

#include "platform_models/loader/loader.h"
#include "sim/soc/job_timer.h"
#include "sim/work/machine.h"
#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;
using P = work::Counting;

constexpr int kRows = 240;  // the same for each of 1, 2, 4, 8 and 16 cores
constexpr int kColumns = 64;

std::string of(const char* path, double value) { return fmt::format("{}={}", path, value); }

/// A picture comes in by DMA; every core takes rows of it, with more floating-point work and
/// divisions than the shared units keep up with.
work::Job recorded(int cores, Bytes l1) {
  work::Machine machine({.cores = cores, .capacity = l1, .record = true});
  {
    const auto stage = machine.stage("rows");
    work::Arena::Frame frame(machine.local());
    std::vector<work::F32> l2(kRows * kColumns, work::F32(2.0f));
    auto rows = machine.local().alloc<P::Span<P::F32>>("rows", kRows * kColumns);
    machine.copy_in(rows, P::L2Span<P::F32>(l2.data(), kRows * kColumns));
    machine.fork("rows", [&](work::Core& core) {
      const work::Share share = core.share(kRows);
      for (const int row : P::range(share.begin, share.end)) {
        P::F32 sum = 0.0f;
        for (const int column : P::range(0, kColumns)) {
          const P::F32 x = rows[row * kColumns + column];
          sum = sum + x * x + x * sum + x;
        }
        rows[row * kColumns] = sum / rows[row * kColumns + 1];
      }
    });
  }
  return machine.take_job();
}

double cycles(std::vector<std::string> overrides) {
  const sim::ChipConfig chip = platform::load_platform("gap9", overrides);
  const work::Job job = recorded(chip.cluster.workers, chip.cluster.l1.size);
  soc::JobTimer timer(chip, chip.cluster.workers);
  return static_cast<double>(timer.front_end_cycles(timer.front_end(job)).count());
}

/// Values of one parameter in an order in which the time must fall, or at least not rise.
struct Variant {
  const char* name;
  const char* path;
  std::vector<double> values;
  std::vector<std::string> with;  ///< other overrides
  double least_gain;              ///< by which the last is faster than the first
};

class ChipVariants : public ::testing::TestWithParam<Variant> {};

TEST_P(ChipVariants, MoreIsNeverSlower) {
  const Variant& variant = GetParam();
  std::vector<double> times;
  for (const double value : variant.values) {
    std::vector<std::string> overrides = variant.with;
    overrides.push_back(of(variant.path, value));
    times.push_back(cycles(overrides));
    if (times.size() > 1) {
      EXPECT_LE(times.back(), times[times.size() - 2]) << value;
    }
  }
  EXPECT_GE(times.front() / times.back(), variant.least_gain);
}

std::vector<double> up_to_16() {
  std::vector<double> values;
  for (int n = 1; n <= 16; ++n) values.push_back(n);
  return values;
}

INSTANTIATE_TEST_SUITE_P(
    OfGap9, ChipVariants,
    ::testing::Values(
        Variant{"cores", "cluster.workers", {1, 2, 4, 8, 16}, {"cluster.max_workers=16"}, 3},
        Variant{"units", "cluster.fpu.units", up_to_16(), {"cluster.fpu.mapping=dynamic"}, 2},
        Variant{"fixed_units", "cluster.fpu.units", {1, 2, 4, 8, 16}, {}, 2},
        Variant{"dividers", "cluster.fpu.dividers", {1, 2, 3, 4}, {"cluster.fpu.units=8"}, 1},
        Variant{"l1", "cluster.l1.size", {64, 128, 256, 512}, {}, 1},
        Variant{"dma", "cluster.dma.bytes_per_cycle", {4, 8, 16}, {}, 1.1}),
    [](const auto& variant) { return std::string(variant.param.name); });

/// Any number of cores, whether it divides the work evenly or not.
TEST(VariantsOfGap9, RunOn1To16Cores) {
  const double one = cycles({"cluster.workers=1", "cluster.max_workers=16"});
  for (int n = 2; n <= 16; ++n) {
    const double time = cycles({of("cluster.workers", n), "cluster.max_workers=16"});
    EXPECT_LT(time, one) << n;
    EXPECT_GE(time * n, one * 0.9) << n;
  }
}

/// Three units for eight cores: cores 0, 3 and 6 share one, any core may take any if it is dynamic.
TEST(VariantsOfGap9, DynamicMappingIsNeverSlower) {
  for (const int units : {1, 2, 3, 4, 5, 8, 16})
    EXPECT_LE(cycles({of("cluster.fpu.units", units), "cluster.fpu.mapping=dynamic"}),
              cycles({of("cluster.fpu.units", units)}))
        << units;
  EXPECT_LT(cycles({"cluster.fpu.units=3", "cluster.fpu.mapping=dynamic"}),
            cycles({"cluster.fpu.units=3"}));
}

TEST(VariantsOfGap9, ThatAreImpossibleAreRefusedWithTheReason) {
  expect_input_error([] { cycles({"cluster.workers=16"}); },
                     {"cluster.workers is 16", "cluster.max_workers is 8",
                      "no more workers than the event unit serves"});
  expect_input_error([] { cycles({"cluster.workers=0"}); }, {"cluster.workers"});
  expect_input_error([] { cycles({"cluster.fpu.units=0"}); },
                     {"cluster.fpu.units is 0", "isa.ops.f", "at least one"});
  expect_input_error([] { cycles({"cluster.fpu.dividers=0"}); }, {"cluster.fpu.dividers is 0"});
  expect_input_error([] { cycles({"cluster.l1.size=32KiB"}); }, {"block 'rows'", "L1", "bytes"});
  expect_input_error([] { cycles({"cluster.clock=400MHz"}); },
                     {"cluster.clock is 400 MHz", "supply.voltage is 0.8"});
}

}  // namespace
}  // namespace leviosim::tools
