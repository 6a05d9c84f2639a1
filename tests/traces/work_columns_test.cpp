// Series of counts come back as they were, whatever they are, and dependent counters cost nothing.
#include "traces/work_traces/work_columns.h"
#include "sim/work/op.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sim/base/error.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using work::Op;

FileFields all_fields() {
  FileFields fields(kCounters);
  std::iota(fields.begin(), fields.end(), 0);
  return fields;
}

struct Written {
  std::string head;
  std::string columns;
};

Written written(const CountsSeries& series) {
  ByteWriter head;
  ByteWriter columns;
  write_series(series, head, columns);
  return {head.take(), columns.take()};
}

void expect_round_trip(const CountsSeries& series) {
  const Written text = written(series);
  const std::string place = "test";
  ByteReader head(text.head, place);
  ByteReader columns(text.columns, place);
  const FileFields fields = all_fields();
  SeriesReader reader(head, columns, fields);
  head.expect_end();
  columns.expect_end();
  for (std::size_t i = 0; i < series.size(); ++i) {
    work::Counts counts;
    reader.next(counts);
    ASSERT_EQ(counts, series[i]) << i;
  }
  reader.expect_end();
}

/// A program of so many basic blocks, each of which counts some operations.
CountsSeries program(Rng& rng, std::size_t blocks, std::size_t segments) {
  std::vector<work::Counts> block_counts(blocks);
  for (work::Counts& counts : block_counts)
    for (int i = 0; i < 6; ++i) counter(counts, rng.next() % kCounters) += rng.next() % 5;
  CountsSeries series(segments);
  for (work::Counts& counts : series)
    for (const work::Counts& block : block_counts)
      for (std::uint64_t visits = rng.next() % 40; visits > 0; --visits) counts += block;
  return series;
}

TEST(WorkColumns, RandomProgramsComeBack) {
  Rng rng(3);
  for (int trial = 0; trial < 200; ++trial)
    expect_round_trip(program(rng, 1 + rng.next() % 8, 1 + rng.next() % 60));
}

TEST(WorkColumns, RandomCountsComeBack) {
  Rng rng(5);
  for (int trial = 0; trial < 50; ++trial) {
    CountsSeries series(1 + rng.next() % 40);
    for (work::Counts& counts : series)
      for (std::size_t k = 0; k < kCounters; ++k)
        counter(counts, k) = rng.next() >> (64 - rng.next() % kCounterBits - 1);
    expect_round_trip(series);
  }
}

/// A dependence that holds in the beginning of a long series only is none.
TEST(WorkColumns, LateSurprisesComeBack) {
  CountsSeries series(1000);
  for (std::size_t i = 0; i < series.size(); ++i) {
    series[i][Op::LoopIteration] = i % 17;
    series[i][Op::IntAlu] = 2 * (i % 17);
  }
  series.back()[Op::IntAlu] = 5;
  expect_round_trip(series);
}

TEST(WorkColumns, SumsOfOtherCountersAreNotStored) {
  Rng rng(9);
  CountsSeries series(500);
  for (work::Counts& counts : series) {
    const std::uint64_t a = rng.next() % 100;
    const std::uint64_t b = rng.next() % 100;
    counts[Op::LoopIteration] = a;
    counts[Op::BranchTaken] = b;
    counts[Op::IntAlu] = 4 * a + 7 * b + 13;
    counts[Op::F32Fma] = 9 * a;
    counts[Op::BranchNotTaken] = 1000 + a - b;
  }
  expect_round_trip(series);
  // Two columns of differences below 100: two bytes each at most.
  EXPECT_LE(written(series).columns.size(), 2 * 2 * (series.size() - 1));
}

TEST(WorkColumns, EqualSegmentsTakeNoColumns) {
  work::Counts counts;
  counts[Op::F64Mul] = 12'345;
  EXPECT_EQ(written(CountsSeries(100, counts)).columns.size(), 0u);
  expect_round_trip(CountsSeries(100, counts));
}

/// Counts that no recording has would overflow what is derived from them.
TEST(WorkColumns, AbsurdCountsAreRefused) {
  CountsSeries series(2);
  series[1][Op::IntAlu] = std::uint64_t{1} << kCounterBits;
  EXPECT_THROW(expect_round_trip(series), InputError);
  series[0][Op::IntAlu] = 5;
  series[1][Op::IntAlu] = static_cast<std::uint64_t>(-1);
  EXPECT_THROW(expect_round_trip(series), InputError);
}

}  // namespace
}  // namespace leviosim::traces
