// Memories, instruction caches, synchronisation and transfers.
#include <fmt/format.h>

#include <array>
#include <string>

#include "sim/base/error.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/unit_benches.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {
namespace {

using P = work::Counting;
using F32 = P::F32;
using I32 = P::I32;

constexpr int kLoads = 20'000;
constexpr int kWords = 64;

/// Cycles of one of `kLoads` steps per core; step(words, core).
template <class View, class Step>
double per_step(const sim::ChipConfig& chip, int cores, Step step) {
  const std::array<F32, kWords> memory{};
  return stream_cycles(as_assembly(chip), cores, kLoads, [&](work::Core&) {
    const View words(memory.data(), kWords);
    for (int i = 0; i < kLoads; ++i) step(words);
  });
}

double loads_of_one_word(const sim::ChipConfig& chip, int cores) {
  return per_step<P::SharedSpan<const F32>>(
      chip, cores, [](auto words) { [[maybe_unused]] const F32 x = words[0]; });
}
double loads_in_step(const sim::ChipConfig& chip, int cores) {
  return per_step<P::Span<const F32>>(chip, cores,
                                      [](auto words) { [[maybe_unused]] const F32 x = words[0]; });
}
/// An address to compute, a load, and one more instruction.
double loads_at_random(const sim::ChipConfig& chip, int cores) {
  return per_step<P::Span<const F32>>(chip, cores, [i = I32(5)](auto words) {
    [[maybe_unused]] const F32 x = words[i];
    [[maybe_unused]] const I32 j = i & i;
  });
}
double load_from_l2(const sim::ChipConfig& chip, int cores) {
  return per_step<P::L2Span<const F32>>(
      chip, cores, [](auto words) { [[maybe_unused]] const F32 x = words[0]; });
}

/// Bytes in L2 and room for them in L1.
struct Buffers {
  explicit Buffers(work::Machine& machine, int bytes)
      : l2(storage.data(), bytes), l1(machine.local().alloc<P::Span<P::Byte>>("buffer", bytes)) {}

  std::vector<P::Byte> storage = std::vector<P::Byte>(1 << 18);
  work::CountedSpan<P::Byte, work::Space::L2> l2;
  P::Span<P::Byte> l1;
};

double loads_in_step_beside_dma(const sim::ChipConfig& chip, int cores) {
  Bench bench(as_assembly(chip), cores);
  const std::array<F32, kWords> memory{};
  const sim::StageTiming timing = bench.run([&](work::Machine& machine) {
    Buffers buffers(machine, 1 << 16);  // more than the loads take
    const work::Machine::Ticket ticket = machine.start_copy_in(buffers.l1, buffers.l2);
    const work::Machine::Ticket more = machine.start_copy_in(buffers.l1, buffers.l2);
    const work::Machine::Ticket last = machine.start_copy_in(buffers.l1, buffers.l2);
    machine.fork("loads", [&](work::Core&) {
      const P::Span<const F32> words(memory.data(), kWords);
      for (int i = 0; i < kLoads; ++i) [[maybe_unused]] const F32 x = words[0];
    });
    machine.wait(ticket);
    machine.wait(more);
    machine.wait(last);
  });
  return 1 + timing.account.team[sim::Mechanism::Banks] / (static_cast<double>(cores) * kLoads);
}

template <int Bytes>
double transfer(const sim::ChipConfig& chip, int) {
  return static_cast<double>(Bench(chip, 1)
                                 .run([](work::Machine& machine) {
                                   Buffers buffers(machine, Bytes);
                                   machine.copy_in(buffers.l1, buffers.l2);
                                 })
                                 .cycles.count());
}

double both_directions(const sim::ChipConfig& chip, int) {
  return static_cast<double>(Bench(chip, 1)
                                 .run([](work::Machine& machine) {
                                   Buffers buffers(machine, 1 << 16);
                                   const work::Machine::Ticket in =
                                       machine.start_copy_in(buffers.l1, buffers.l2);
                                   const work::Machine::Ticket out =
                                       machine.start_copy_out(buffers.l2, buffers.l1);
                                   machine.wait(in);
                                   machine.wait(out);
                                 })
                                 .cycles.count());
}

/// MB/s of the controller's transfers from external memory.
template <int Bytes>
double external_read(const sim::ChipConfig& chip, int) {
  return Bytes / (Bench(chip, 1).controller_seconds([](work::Machine& machine) {
           Buffers buffers(machine, Bytes);
           machine.load_external(buffers.l1, buffers.l2);
         }) * 1e6);
}

/// Straight-line code of 4-byte instructions in a loop: cycles per instruction once it is warm.
template <int Bytes>
double code_loop(const sim::ChipConfig& chip, int cores) {
  constexpr int kPart = 64;
  constexpr int kRounds = 50;
  work::CodeMap code;
  for (int part = 0; part < Bytes / kPart; ++part) code.add(std::to_string(part), "", kPart);
  const auto cycles = [&](int rounds) {
    Bench bench(as_assembly(chip), cores, &code);
    const auto walk = [&](work::Core&) {
      for (int round = 0; round < rounds; ++round)
        for (int part = 0; part < Bytes / kPart; ++part) {
          const work::Counting::Code segment{work::CodeName(std::to_string(part))};
          I32 x(1);
          for (int i = 0; i < kPart / 4; ++i) x = x & x;
        }
    };
    return static_cast<double>(bench.fork(walk).cycles.count());
  };
  return (cycles(2 * kRounds) - cycles(kRounds)) / (kRounds * (Bytes / 4.0));
}

/// What synchronisation costs a team beyond the start of its fork.
double barrier(const sim::ChipConfig& chip, int cores) {
  const sim::StageTiming timing = Bench(chip, cores).fork([](work::Core& core) {
    I32 x(1);
    for (int i = 0; i < 100 * core.id; ++i) x = x & x;
  });
  const sim::EventUnitConfig& events = chip.cluster.events;
  return timing.account.team[sim::Mechanism::Synchronisation] / cores - events.fork_master -
         events.fork_worker;
}

double empty_fork(const sim::ChipConfig& chip, int cores) {
  return static_cast<double>(Bench(chip, cores).fork([](work::Core&) {}).cycles.count());
}

/// What a fork takes right after another one.
double fork_again(const sim::ChipConfig& chip, int cores) {
  const auto forks = [&](int n) {
    return static_cast<double>(Bench(chip, cores)
                                   .run([&](work::Machine& machine) {
                                     for (int i = 0; i < n; ++i)
                                       machine.fork("empty", [](work::Core&) {});
                                   })
                                   .cycles.count());
  };
  return forks(2) - forks(1);
}

double offload_and_back(const sim::ChipConfig& chip, int cores) {
  return Bench(chip, cores).offload_cycles();
}

constexpr std::array kMemoryBenches = {
    UnitBench{"loads of one word", loads_of_one_word},
    UnitBench{"loads in step", loads_in_step},
    UnitBench{"loads at random", loads_at_random},
    UnitBench{"loads in step beside the DMA", loads_in_step_beside_dma},
    UnitBench{"load from L2", load_from_l2},
    UnitBench{"loop of 256 B", code_loop<256>},
    UnitBench{"loop of 512 B", code_loop<512>},
    UnitBench{"loop of 4096 B", code_loop<4096>},
    UnitBench{"loop of 32768 B", code_loop<32768>},
    UnitBench{"barrier after the last arrival", barrier},
    UnitBench{"empty fork and join", empty_fork},
    UnitBench{"empty fork right after another", fork_again},
    UnitBench{"offload and back", offload_and_back},
    UnitBench{"transfer of 4 B", transfer<4>},
    UnitBench{"transfer of 64 B", transfer<64>},
    UnitBench{"transfer of 256 B", transfer<256>},
    UnitBench{"transfer of 1024 B", transfer<1024>},
    UnitBench{"transfer of 19200 B", transfer<19200>},
    UnitBench{"transfer of 65536 B", transfer<65536>},
    UnitBench{"read of 4 B", external_read<4>},
    UnitBench{"read of 64 B", external_read<64>},
    UnitBench{"read of 256 B", external_read<256>},
    UnitBench{"read of 1024 B", external_read<1024>},
    UnitBench{"read of 4096 B", external_read<4096>},
    UnitBench{"read of 8192 B", external_read<8192>},
    UnitBench{"65536 B in both directions at once", both_directions},
};

}  // namespace

std::span<const UnitBench> memory_benches() { return kMemoryBenches; }

namespace {

constexpr std::string_view kUnitReferences = "gap9_units";
constexpr std::string_view kUnitGuards = "gap9_unit_guards";

const UnitBench& bench_named(const std::string& name) {
  for (const auto benches : {stream_benches(), memory_benches()})
    for (const UnitBench& bench : benches)
      if (bench.name == name) return bench;
  throw InputError(fmt::format("{}.csv: there is no program \"{}\"", kUnitReferences, name));
}

}  // namespace

std::vector<MicrobenchRow> unit_rows(const sim::ChipConfig& chip) {
  std::vector<MicrobenchRow> rows =
      reference_rows(fmt::format("{}.csv", kUnitReferences), reference_text(kUnitReferences), 1);
  for (MicrobenchRow& row : rows) row.simulated = bench_named(row.name).measure(chip, row.cores);
  take_guards(fmt::format("{}.csv", kUnitGuards), reference_text(kUnitGuards), rows);
  return rows;
}

}  // namespace leviosim::tools
