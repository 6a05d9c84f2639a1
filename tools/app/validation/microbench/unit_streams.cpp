// Streams of one kind of instruction, unrolled as the vendor's calibration programs are: loops over
// a plain int cost nothing.
#include <array>

#include "sim/work/half.h"
#include "sim/work/wide.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/unit_benches.h"

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

}  // namespace

std::span<const UnitBench> stream_benches() { return kStreamBenches; }

}  // namespace leviosim::tools
