// Counted loops: ranges that a kernel's loops go over, made by P::range and P::down_range.
//
// A loop counts its entry and its iterations. Cores with hardware loops repeat a loop for free only
// if it is one of the two innermost of a nest, and if nothing in it jumps: no calls, no branches,
// no emulated arithmetic (FACTS.md#instruction-set). Iterations of other loops are counted once
// more, as jumps. Whether there are hardware loops is the platform's business.
//
// Left out: jumps of conditions that are no counted scalars, and single precision where it is
// emulated.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/work/counts.h"
#include "sim/work/op.h"

namespace leviosim::work {

/// How many loops deep the deepest loop was that ended last in the present one, on this thread.
inline constinit thread_local int loops_within = 0;

template <bool Counted>
class LoopScope {
 public:
  void end(int) const {}
};

template <>
class LoopScope<true> {
 public:
  LoopScope() : siblings_(loops_within), jumps_(jumps()) {
    count(Op::LoopEntry);
    loops_within = 0;
  }
  void end(int iterations) const {
    constexpr int kHardwareLoops = 2;
    const int deep = loops_within + 1;
    if (deep > kHardwareLoops || jumps() != jumps_)
      count(Op::LoopJump, static_cast<std::uint64_t>(iterations));
    loops_within = std::max(siblings_, deep);
  }

 private:
  /// A number that differs if something has jumped in between. Branches are all counted as not
  /// taken at first (counts.h).
  static std::uint64_t jumps() {
    return tally[Op::BranchNotTaken] + tally[Op::Call] + tally[Op::F64Add] + tally[Op::F64Mul] +
           tally[Op::F64Div] + tally[Op::F64Compare] + tally[Op::F64Convert];
  }

  int siblings_;  ///< loops_within of the loop around this one so far
  std::uint64_t jumps_;
};

/// Integers begin, begin + Step, … as long as they are on this side of the end.
/// @tparam Counter  what the program for the target counts in; it must hold begin and end
template <bool Counted, int Step, class Counter = int>
class SteppedRange {
 public:
  class Iterator {
   public:
    explicit Iterator(SteppedRange* range) : range_(range) {}
    int operator*() const { return range_->i_; }
    Iterator& operator++() {
      if constexpr (Counted) count(Op::LoopIteration);
      range_->i_ = static_cast<Counter>(range_->i_ + Step);
      return *this;
    }
    bool operator!=(Counter end) const { return Step > 0 ? range_->i_ < end : range_->i_ > end; }

   private:
    SteppedRange* range_;
  };

  SteppedRange(int begin, int end)
      : i_(static_cast<Counter>(begin)), begin_(i_), end_(static_cast<Counter>(end)) {}
  ~SteppedRange() { scope_.end((i_ - begin_) / Step); }
  SteppedRange(const SteppedRange&) = delete;
  SteppedRange& operator=(const SteppedRange&) = delete;

  Iterator begin() { return Iterator(this); }
  Counter end() const { return end_; }

 private:
  Counter i_;
  Counter begin_;
  Counter end_;
  [[no_unique_address]] LoopScope<Counted> scope_;
};

/// begin, begin + 1, … below end.
template <bool Counted>
using Range = SteppedRange<Counted, 1>;
/// The same, counted in a byte. The compiler does not know that the count stays below 256, so it
/// computes addresses from it in every step.
template <bool Counted>
using ByteRange = SteppedRange<Counted, 1, std::uint8_t>;
/// begin, begin - 1, … down to and including last: the end is one below it.
template <bool Counted>
using DownRange = SteppedRange<Counted, -1>;

}  // namespace leviosim::work
