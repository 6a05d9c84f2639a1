// Columns of a work trace: how the counts of many similar work segments become few bytes, and come
// back fast. Segments of work at the same place of a program form a *series*. The first of a series
// is stored as it is. Of the counters that change at all, some are stored as differences from
// segment to segment; the others are sums of multiples of these, since the operations of a program
// come in the proportions of its basic blocks, of which it has fewer than kinds of operations.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "sim/work/counts.h"
#include "traces/work_traces/bytes.h"

namespace leviosim::traces {

/// All counters of work::Counts as one list: operations, classes of code reuse, compiled work.
inline constexpr std::size_t kFirstCompiled = work::kOpCount + work::kReuseClasses;
inline constexpr std::size_t kCounters = kFirstCompiled + work::CompiledSets{}.size();
/// No work segment counts as much; keeps what is derived from counts from overflowing.
inline constexpr int kCounterBits = 40;

inline std::uint64_t& counter(work::Counts& counts, std::size_t k) {
  if (k < work::kOpCount) return counts.n[k];
  return k < kFirstCompiled ? counts.code[k - work::kOpCount] : counts.compiled[k - kFirstCompiled];
}
inline std::uint64_t counter(const work::Counts& counts, std::size_t k) {
  if (k < work::kOpCount) return counts.n[k];
  return k < kFirstCompiled ? counts.code[k - work::kOpCount] : counts.compiled[k - kFirstCompiled];
}

/// Which counter of this program each field of a file is.
using FileFields = std::vector<std::size_t>;

/// Segments of a series. Not in one block: it would be moved as it grows, and counts are large.
using CountsSeries = std::deque<work::Counts>;

/// Appends the description of a series to `head`, its differences to `columns`.
void write_series(const CountsSeries& series, ByteWriter& head, ByteWriter& columns);

/// Gives the segments of a series back, one after the other.
class SeriesReader {
 public:
  /// @param code  the instruction set whose compiled work is asked for; that of others is then
  ///              anything
  /// @throws InputError for what write_series() would not write
  SeriesReader(ByteReader& head, ByteReader& columns, const FileFields& fields,
               std::optional<work::CompiledFor> code = {});

  void next(work::Counts& counts);
  /// What next() would go through, as a series of that file again. Nothing is left to read then.
  void write(const FileFields& fields, ByteWriter& head, ByteWriter& columns);
  /// Of what next() goes through. [bytes]
  std::size_t size() const {
    return columns_.size() * sizeof(Column) + terms_.size() * sizeof(Term) +
           sums_.size() * sizeof(Sum);
  }
  /// @throws InputError if segments are left
  void expect_end();

 private:
  [[noreturn]] void fail_count() const;
  void leave_out_others(work::CompiledFor code);

  struct Column {
    std::size_t counter;
    ByteReader differences;
  };
  struct Term {
    std::size_t counter;
    std::uint64_t factor;
  };
  struct Sum {
    std::size_t counter;
    std::uint64_t constant;
    std::size_t first_term, end_term;
  };

  const std::string* place_;
  bool first_ = true;
  work::Counts present_;
  std::vector<Column> columns_;
  std::vector<Term> terms_;
  std::vector<Sum> sums_;
};

/// Kinds of step.
enum : std::uint64_t {
  kSerial,
  kFork,
  kForkWithMaster,
  kTransfer,
  kBackgroundTransfer,
  kWait,
  kForkAlignedOnOneCore
};
inline constexpr std::uint64_t kStepKinds = kForkAlignedOnOneCore + 1;
inline constexpr std::uint64_t kDirections = 4;
inline constexpr std::uint64_t kKeyframe = 1, kBusy = 2, kOptimised = 4, kAllFlags = 7;

}  // namespace leviosim::traces
