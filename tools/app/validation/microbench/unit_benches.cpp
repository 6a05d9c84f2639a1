// Memories, instruction caches, synchronisation and transfers.
#include "tools/app/validation/microbench/unit_benches.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "sim/base/error.h"
#include "sim/chip/account.h"
#include "sim/chip/timing.h"
#include "sim/work/half.h"
#include "sim/work/op.h"
#include "sim/work/wide.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/reference_rows.h"
#include "tools/app/validation/published_files.h"

namespace leviosim::tools {
namespace {

using P = work::Counting;
using F32 = P::F32;
using I32 = P::I32;
using F16 = work::F16<P>;
using I64 = work::I64<P>;

constexpr int kSlots = 20'000;

/// Cycles per slot of a stream; `step` is `slots` slots of it.
template <class Step>
double stream(const sim::ChipConfig& chip, int cores, int slots, Step step) {
  return stream_cycles(as_assembly(chip), cores, kSlots, [&](work::Core& core) {
    for (int i = 0; i < kSlots; i += slots) step(core.id);
  });
}

/// The same, with another stream on the cores from `first` on; the time of the longest.
template <class Step, class Other>
double two_streams(const sim::ChipConfig& chip, int cores, int first, Step step, Other other) {
  return stream(chip, cores, 1, [&](int core) { core < first ? step() : other(); });
}

/// What the streams compute with; values stay finite.
struct Registers {
  F32 a{1.5F};
  F32 b{0.75F};
  F16 h{1.5F};
  I64 wide{3};
  I32 i{7};

  void add() { a = b + b; }
  void mul() { a = b * b; }
  void madd() { a = b * b + b; }
  void min() { a = work::min(b, b); }
  void sign() { a = -b; }
  void div() { a = b / b; }
  void sqrt() { a = work::sqrt(b); }
  void half_mac() { h = mul_add(h, F16(0.5F), F16(0.5F)); }
  void half_div() { h = F16(1.5F) / F16(1.25F); }
  void wide_add() { wide = I64(3) + I64(4); }
  void nop() { i = i & i; }
};

template <void (Registers::*Step)()>
double shared(const sim::ChipConfig& chip, int cores) {
  Registers r;
  return stream(chip, cores, 1, [&](int) { (r.*Step)(); });
}

template <void (Registers::*Step)()>
double shared_and_nop(const sim::ChipConfig& chip, int cores) {
  Registers r;
  return stream(chip, cores, 2, [&](int) {
    (r.*Step)();
    r.nop();
  });
}

template <int First, void (Registers::*A)(), void (Registers::*B)()>
double mixed(const sim::ChipConfig& chip, int cores) {
  Registers r;
  return two_streams(
      chip, cores, First, [&] { (r.*A)(); }, [&] { (r.*B)(); });
}

/// One core divides among others that add as fast as they can; the time of the dividing core.
double division_beside_sums(const sim::ChipConfig& chip, int cores) {
  Registers r;
  constexpr int kSumsPerDivision = 14;
  return stream_cycles(as_assembly(chip), cores, kSlots, [&](work::Core& core) {
    for (int i = 0; i < kSlots; ++i)
      if (core.id == 0)
        r.div();
      else
        for (int k = 0; k < kSumsPerDivision / 2; ++k) r.add();  // pairs take twice as long
  });
}

/// Cycles of a sequence on the master alone.
template <class Step>
double sequence(const sim::ChipConfig& chip, Step step) {
  Bench bench(chip, 1);
  const sim::StageTiming timing = bench.run([&](work::Machine& machine) {
    const auto words = machine.local().alloc<P::Span<F32>>("words", 64);
    for (int i = 0; i < kSlots; ++i) step(words);
  });
  return static_cast<double>(timing.cycles.count()) / kSlots;
}

double load(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [](auto words) { [[maybe_unused]] const F32 x = words[3]; });
}
double load_and_use(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip, 1.0), [r = Registers()](auto words) mutable {
    [[maybe_unused]] const F32 x = words[3];
    r.nop();
  });
}
/// A memory that answers after five cycles stands for L2.
double slow_load_and_two_adds(const sim::ChipConfig& chip, int) {
  sim::ChipConfig slow = as_assembly(chip);
  slow.cluster.core.ops[work::index(work::Op::LoadL2)].stall = 5 - 1;
  return sequence(slow, [r = Registers()](auto words) mutable {
    [[maybe_unused]] const F32 x = P::L2Span<F32>(words.data(), 4)[3];
    r.nop();
    r.nop();
  });
}
double load_across_words(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [](auto words) {
    [[maybe_unused]] const F32 x = P::Span<F32>(words.data(), 4, true)[3];
  });
}
template <bool Taken>
double branch(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [](auto) {
    // The branch around the guarded code is taken if the condition does not hold.
    const work::Cond condition{!Taken};
    if (condition) return;
  });
}
double jump_to_computed(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [r = Registers()](auto) mutable {
    r.nop();  // upper and lower part of the address
    r.nop();
    P::jump_to_computed();
  });
}
double product(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [a = I32(7)](auto) { [[maybe_unused]] const I32 x = a * a; });
}
double upper_product(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip), [a = I32(7)](auto) { work::mul_high(a, a); });
}
template <std::int32_t Divisor>
double division(const sim::ChipConfig& chip, int) {
  return sequence(as_assembly(chip),
                  [a = I32(7)](auto) { [[maybe_unused]] const I32 x = a / I32(Divisor); });
}
constexpr std::array kStreamBenches = {
    UnitBench{"fp32 add", shared<&Registers::add>},
    UnitBench{"fp32 mul", shared<&Registers::mul>},
    UnitBench{"fp32 madd", shared<&Registers::madd>},
    UnitBench{"fp32 min", shared<&Registers::min>},
    UnitBench{"fp32 sign", shared<&Registers::sign>},
    UnitBench{"fp32 div", shared<&Registers::div>},
    UnitBench{"fp32 sqrt", shared<&Registers::sqrt>},
    UnitBench{"fp16 mac", shared<&Registers::half_mac>},
    UnitBench{"fp16 div", shared<&Registers::half_div>},
    UnitBench{"int64 add", shared<&Registers::wide_add>},
    UnitBench{"fp32 add and nop", shared_and_nop<&Registers::add>},
    UnitBench{"fp32 div and nop", shared_and_nop<&Registers::div>},
    UnitBench{"4 cores fp32 div and 4 cores fp16 div",
              mixed<4, &Registers::div, &Registers::half_div>},
    UnitBench{"2 cores fp32 div and 6 cores fp16 div",
              mixed<2, &Registers::div, &Registers::half_div>},
    UnitBench{"4 cores int64 add and 4 cores fp32 add",
              mixed<4, &Registers::wide_add, &Registers::add>},
    UnitBench{"fp32 div beside 7 cores fp32 add", division_beside_sums},
    UnitBench{"load", load},
    UnitBench{"load and its use", load_and_use},
    UnitBench{"load after 5 cycles and two adds", slow_load_and_two_adds},
    UnitBench{"load across words", load_across_words},
    UnitBench{"branch taken", branch<true>},
    UnitBench{"branch not taken", branch<false>},
    UnitBench{"jump to computed address", jump_to_computed},
    UnitBench{"mul", product},
    UnitBench{"mulh", upper_product},
    UnitBench{"div by 0x9876", division<0x9876>},
    UnitBench{"div by 1", division<1>},
    UnitBench{"div by 0x40000000", division<0x40000000>},
    UnitBench{"div by 0", division<0>},
};

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
           machine.copy_in(buffers.l1, buffers.l2);
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

constexpr std::string_view kUnitReferences = "gap9_units";
constexpr std::string_view kUnitGuards = "gap9_unit_guards";

const UnitBench& bench_named(const std::string& name) {
  for (const auto benches : {stream_benches(), memory_benches()})
    for (const UnitBench& bench : benches)
      if (bench.name == name) return bench;
  throw InputError(fmt::format("{}.csv: there is no program \"{}\"", kUnitReferences, name));
}

}  // namespace

std::span<const UnitBench> stream_benches() { return kStreamBenches; }

std::span<const UnitBench> memory_benches() { return kMemoryBenches; }

std::vector<MicrobenchRow> unit_rows(const sim::ChipConfig& chip) {
  std::vector<MicrobenchRow> rows =
      reference_rows(fmt::format("{}.csv", kUnitReferences), reference_text(kUnitReferences), 1);
  for (MicrobenchRow& row : rows) row.simulated = bench_named(row.name).measure(chip, row.cores);
  take_guards(fmt::format("{}.csv", kUnitGuards), reference_text(kUnitGuards), rows);
  return rows;
}

}  // namespace leviosim::tools
