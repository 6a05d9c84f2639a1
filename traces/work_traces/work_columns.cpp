#include "traces/work_traces/work_columns.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "sim/base/error.h"

namespace leviosim::traces {
namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 31) - 1;
/// Segments from which dependences are guessed; they are then compared with all.
constexpr std::size_t kSample = 256;
/// Compiled work of a visit is a large multiple of what counts visits.
constexpr std::int64_t kLargestFactor = std::int64_t{1} << 24;

using Vector = std::vector<std::uint64_t>;  ///< modulo kPrime

std::uint64_t modulo(std::uint64_t difference) {
  const auto value = static_cast<std::int64_t>(difference) % static_cast<std::int64_t>(kPrime);
  return static_cast<std::uint64_t>(value < 0 ? value + static_cast<std::int64_t>(kPrime) : value);
}

std::uint64_t inverse(std::uint64_t value) {
  std::uint64_t result = 1;
  for (std::uint64_t power = kPrime - 2; power > 0; power >>= 1) {
    if (power & 1) result = result * value % kPrime;
    value = value * value % kPrime;
  }
  return result;
}

/// a -= factor · b
void subtract(Vector& a, std::uint64_t factor, const Vector& b) {
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = (a[i] + (kPrime - factor) * b[i]) % kPrime;
}

struct Term {
  std::size_t counter;
  std::int64_t factor;
};

/// Finds out which columns of differences are sums of multiples of others, by elimination.
class Dependences {
 public:
  explicit Dependences(std::size_t rows) : rows_(std::min(rows - 1, kSample)) {}

  /// The sum that the counter is, of counters that were kept before; else it is kept itself.
  std::optional<std::vector<Term>> find(std::size_t k, const CountsSeries& series) {
    Vector rest(rows_);
    for (std::size_t r = 0; r < rows_; ++r)
      rest[r] = modulo(counter(series[r + 1], k) - counter(series[r], k));
    Vector factors(kept_.size(), 0);  // the column = rest + Σ factors · kept columns
    for (const Row& row : reduced_) {
      const std::uint64_t factor = rest[row.pivot];
      if (factor == 0) continue;
      subtract(rest, factor, row.values);
      subtract(factors, kPrime - factor, row.of_kept);
    }
    const auto pivot = std::find_if(rest.begin(), rest.end(), [](auto v) { return v != 0; });
    if (pivot == rest.end()) return sum_of(factors, k, series);
    const auto row = static_cast<std::size_t>(pivot - rest.begin());
    keep(k, row, std::move(rest), std::move(factors));
    return std::nullopt;
  }

 private:
  /// values = Σ of_kept · kept columns, and 1 at the pivot.
  struct Row {
    std::size_t pivot;
    Vector values;
    Vector of_kept;
  };

  void keep(std::size_t k, std::size_t pivot, Vector rest, Vector factors) {
    for (std::uint64_t& factor : factors) factor = (kPrime - factor) % kPrime;
    factors.push_back(1);
    const std::uint64_t scale = inverse(rest[pivot]);
    for (Vector* vector : {&rest, &factors})
      for (std::uint64_t& value : *vector) value = value * scale % kPrime;
    kept_.push_back(k);
    reduced_.push_back({pivot, std::move(rest), std::move(factors)});
  }

  std::optional<std::vector<Term>> sum_of(const Vector& factors, std::size_t k,
                                          const CountsSeries& series) const {
    std::vector<Term> terms;
    for (std::size_t i = 0; i < factors.size(); ++i) {
      if (factors[i] == 0) continue;
      auto factor = static_cast<std::int64_t>(factors[i]);
      if (factor > static_cast<std::int64_t>(kPrime / 2)) factor -= kPrime;
      if (std::abs(factor) > kLargestFactor) return std::nullopt;
      terms.push_back({kept_[i], factor});
    }
    for (std::size_t r = 1; r < series.size(); ++r) {
      std::uint64_t sum = 0;
      for (const Term& term : terms)
        sum += static_cast<std::uint64_t>(term.factor) *
               (counter(series[r], term.counter) - counter(series[0], term.counter));
      if (counter(series[r], k) - counter(series[0], k) != sum) return std::nullopt;
    }
    return terms;
  }

  std::size_t rows_;
  std::vector<std::size_t> kept_;
  std::vector<Row> reduced_;
};

/// Of the chips that are asked for most.
constexpr work::CompiledFor kMostReadSet = work::CompiledFor::Rv32imfcXpulp;

bool is_of_another_set(std::size_t counter, work::CompiledFor code) {
  return counter >= kFirstCompiled &&
         (counter - kFirstCompiled) / work::kCompiledCount != static_cast<std::size_t>(code);
}

/// Counters that change within the series, those that change least first: what counts visits of a
/// basic block makes a better basis than sums over several. Those of instruction sets that are
/// read less come last, so that nothing of the other is a sum of them.
std::vector<std::size_t> changing(const CountsSeries& series) {
  std::array<std::uint64_t, kCounters> range{};
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < kCounters; ++k) {
    std::uint64_t low = counter(series[0], k);
    std::uint64_t high = low;
    for (const work::Counts& counts : series) {
      low = std::min(low, counter(counts, k));
      high = std::max(high, counter(counts, k));
    }
    range[k] = high - low;
    if (range[k] > 0) found.push_back(k);
  }
  std::stable_sort(found.begin(), found.end(),
                   [&](std::size_t a, std::size_t b) { return range[a] < range[b]; });
  std::stable_partition(found.begin(), found.end(),
                        [](std::size_t k) { return !is_of_another_set(k, kMostReadSet); });
  return found;
}

ByteWriter differences(const CountsSeries& series, std::size_t k) {
  ByteWriter column;
  for (std::size_t r = 1; r < series.size(); ++r)
    column.integer(static_cast<std::int64_t>(counter(series[r], k) - counter(series[r - 1], k)));
  return column;
}

}  // namespace

void write_series(const CountsSeries& series, ByteWriter& head, ByteWriter& columns) {
  std::vector<std::size_t> first;
  for (std::size_t k = 0; k < kCounters; ++k)
    if (counter(series[0], k) > 0) first.push_back(k);
  head.whole(first.size());
  for (const std::size_t k : first) {
    head.whole(k);
    head.whole(counter(series[0], k));
  }
  std::vector<std::size_t> stored;
  std::vector<std::pair<std::size_t, std::vector<Term>>> sums;
  if (series.size() > 1) {
    Dependences dependences(series.size());
    for (const std::size_t k : changing(series)) {
      if (auto terms = dependences.find(k, series))
        sums.emplace_back(k, std::move(*terms));
      else
        stored.push_back(k);
    }
  }
  head.whole(stored.size());
  for (const std::size_t k : stored) {
    const ByteWriter column = differences(series, k);
    head.whole(k);
    head.whole(column.size());
    columns.append(column.bytes());
  }
  head.whole(sums.size());
  for (const auto& [k, terms] : sums) {
    head.whole(k);
    head.whole(terms.size());
    for (const Term& term : terms) {
      head.whole(term.counter);
      head.integer(term.factor);
    }
  }
}

SeriesReader::SeriesReader(ByteReader& head, ByteReader& columns, const FileFields& fields,
                           std::optional<work::CompiledFor> code)
    : place_(&head.place()) {
  const auto field = [&](const char* what) {
    return fields[static_cast<std::size_t>(head.whole_below(fields.size(), what))];
  };
  // Each counter has one column or sum at most, and a sum has each counter once: what a work
  // segment costs to read is bounded.
  const auto number_of = [&](const char* what, std::size_t memory_each) {
    const auto number = static_cast<std::size_t>(head.whole_below(kCounters + 1, what));
    head.charge(number, memory_each, what);
    return number;
  };
  for (std::size_t i = number_of("counters of a series", 0); i > 0; --i) {
    const std::size_t k = field("a counter");
    counter(present_, k) =
        head.whole_below(std::uint64_t{1} << kCounterBits, "a count at the begin of a series");
  }
  for (std::size_t i = number_of("columns of a series", sizeof(Column)); i > 0; --i) {
    const std::size_t k = field("the counter of a column");
    const auto size = static_cast<std::size_t>(
        head.whole_below(columns.left() + 1, "the number of bytes of a column"));
    columns_.push_back({k, ByteReader(columns.take(size, "a column"), columns.place())});
  }
  for (std::size_t i = number_of("sums of a series", sizeof(Sum)); i > 0; --i) {
    Sum sum{field("the counter of a sum"), 0, terms_.size(), 0};
    sum.constant = counter(present_, sum.counter);
    for (std::size_t j = number_of("terms of a sum", sizeof(Term)); j > 0; --j) {
      const std::size_t k = field("the counter of a term");
      const auto factor = static_cast<std::uint64_t>(head.integer("a factor"));
      terms_.push_back({k, factor});
      sum.constant -= factor * counter(present_, k);
    }
    sum.end_term = terms_.size();
    sums_.push_back(sum);
  }
  if (code) leave_out_others(*code);
}

/// Drops columns and sums of other instruction sets that nothing else is a sum of.
void SeriesReader::leave_out_others(work::CompiledFor code) {
  std::erase_if(sums_, [&](const Sum& sum) { return is_of_another_set(sum.counter, code); });
  std::array<bool, kCounters> used{};
  for (const Sum& sum : sums_)
    for (std::size_t t = sum.first_term; t < sum.end_term; ++t) used[terms_[t].counter] = true;
  std::erase_if(columns_, [&](const Column& column) {
    return is_of_another_set(column.counter, code) && !used[column.counter];
  });
}

void SeriesReader::next(work::Counts& counts) {
  if (!first_) {
    std::uint64_t all = 0;
    for (Column& column : columns_) {
      std::uint64_t& value = counter(present_, column.counter);
      value += static_cast<std::uint64_t>(column.differences.integer("a difference of counts"));
      all |= value;
    }
    for (const Sum& sum : sums_) {
      std::uint64_t value = sum.constant;
      for (std::size_t t = sum.first_term; t < sum.end_term; ++t)
        value += terms_[t].factor * counter(present_, terms_[t].counter);
      counter(present_, sum.counter) = value;
      all |= value;
    }
    if (all >> kCounterBits != 0) [[unlikely]]
      fail_count();
  }
  first_ = false;
  counts = present_;
}

void SeriesReader::write(const FileFields& fields, ByteWriter& head, ByteWriter& columns) {
  const auto number = [&](std::size_t k) {
    const auto field = std::find(fields.begin(), fields.end(), k);
    head.whole(static_cast<std::uint64_t>(field - fields.begin()));
  };
  head.whole(static_cast<std::uint64_t>(std::count_if(
      fields.begin(), fields.end(), [&](auto k) { return counter(present_, k) > 0; })));
  for (const std::size_t k : fields) {
    if (counter(present_, k) == 0) continue;
    number(k);
    head.whole(counter(present_, k));
  }
  head.whole(columns_.size());
  for (Column& column : columns_) {
    number(column.counter);
    const std::size_t size = column.differences.left();
    head.whole(size);
    columns.append(column.differences.take(size, "a column"));
  }
  head.whole(sums_.size());
  for (const Sum& sum : sums_) {
    number(sum.counter);
    head.whole(sum.end_term - sum.first_term);
    for (std::size_t t = sum.first_term; t < sum.end_term; ++t) {
      number(terms_[t].counter);
      head.integer(static_cast<std::int64_t>(terms_[t].factor));
    }
  }
}

void SeriesReader::expect_end() {
  for (Column& column : columns_) column.differences.expect_end();
}

void SeriesReader::fail_count() const {
  throw InputError(fmt::format("{}: a count is negative or beyond 2^{}", *place_, kCounterBits));
}

}  // namespace leviosim::traces
