#include "sim/base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace leviosim::traces {
namespace {

TEST(ParallelFor, EveryJobRunsOnce) {
  for (const unsigned threads : {0u, 1u, 2u, 7u}) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{100}}) {
      std::vector<std::atomic<int>> runs(count);
      base::parallel_for(count, threads, [&](std::size_t i) { ++runs[i]; });
      for (const auto& run : runs) EXPECT_EQ(run, 1);
    }
  }
}

TEST(ParallelFor, AnExceptionReachesTheCallerAndStopsTheRest) {
  for (const unsigned threads : {1u, 3u}) {
    std::atomic<int> runs{0};
    const auto job = [&](std::size_t i) {
      ++runs;
      if (i == 5) throw std::runtime_error("five");
    };
    EXPECT_THROW(base::parallel_for(1'000'000, threads, job), std::runtime_error);
    EXPECT_LT(runs, 1'000'000);
  }
}

}  // namespace
}  // namespace leviosim::traces
