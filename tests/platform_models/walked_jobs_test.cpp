// Jobs that are walked from step to step take what they take in the event kernel, bit by bit, on
// every chip; and what is remembered of another chip changes nothing.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <random>
#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/soc/job_timer.h"
#include "tests/platform_models/timing_jobs.h"
#include "tests/support/event_cluster.h"

namespace leviosim::platform::testing {
namespace {

/// Stages of serial work, forks and transfers, at random: of all kinds of operation or of few,
/// balanced or not, with empty shares, with the master or without, beside data or not.
Job random_job(int cores, unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](unsigned n) { return static_cast<std::uint64_t>(random() % n); };
  const auto share = [&] {
    if (draw(8) == 0) return Segment();
    Segment work = draw(2) == 0 ? some_work(1 + draw(30), draw(9)) : Segment();
    for (const Op op : {Op::IntAlu, Op::F32Fma, Op::F32Div, Op::LoadIndexed, Op::Int64Mac})
      if (draw(3) == 0) work[op] += draw(2000);
    work[Op::LoopIteration] += draw(100);
    work.code[work::reuse_class(512)] += 16 * draw(500);
    return work;
  };
  Job job;
  for (int stage = 0; stage < 3; ++stage) {
    std::vector<work::Step> steps;
    int under_way = 0;
    for (int k = 0; k < 8; ++k) {
      const std::uint64_t kind = draw(5);
      if (kind == 0) {
        steps.push_back(serial(share()));
      } else if (kind == 1) {
        const bool background = draw(3) > 0;
        under_way += background;
        steps.push_back(transfer(static_cast<std::int64_t>(1 + draw(20'000)), background,
                                 draw(2) == 0 ? work::Direction::L2ToL1 : work::Direction::L1ToL2));
      } else {
        const bool with_master = draw(4) == 0;
        std::vector<Segment> shares(static_cast<std::size_t>(cores), share());
        if (draw(3) > 0) std::generate(shares.begin(), shares.end(), share);
        if (with_master) shares.push_back(share());
        steps.emplace_back(work::Fork{"fork", std::move(shares), with_master});
      }
    }
    for (int k = 0; k < under_way; ++k)
      steps.push_back(wait_for(k));  // numbered anew in each job: one stage has them all
    job.stages.push_back({"stage", std::move(steps), {}});
    if (under_way > 0) break;
  }
  return job;
}

void expect_equal(const sim::JobTiming& a, const sim::JobTiming& b, const std::string& where) {
  ASSERT_EQ(a.stages.size(), b.stages.size()) << where;
  for (std::size_t i = 0; i < a.stages.size(); ++i) {
    EXPECT_EQ(a.stages[i].cycles, b.stages[i].cycles) << where;
    EXPECT_EQ(std::memcmp(&a.stages[i].account.team, &b.stages[i].account.team,
                          sizeof a.stages[i].account.team),
              0)
        << where;
  }
}

class WalkedJobs : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Chips, WalkedJobs, ::testing::ValuesIn(platform_names()), name_of_test);

TEST_P(WalkedJobs, TakeWhatTheyTakeInTheEventKernel) {
  ChipConfig chip = load_platform(GetParam());
  for (unsigned seed = 0; seed < 40; ++seed) {
    chip.cluster.dma.commands = static_cast<int>(seed % 4);
    const int workers = 1 + static_cast<int>(seed) % chip.cluster.workers;
    const Job job = random_job(seed % 3 == 0 ? chip.cluster.workers : workers, seed);
    soc::JobTimer timer(chip, workers);
    expect_equal(timer.front_end(job),
                 leviosim::testing::time_in_event_kernel(timer.cluster(), workers, job),
                 fmt::format("job {} on {} cores", seed, workers));
  }
}

/// Every number with a range at both of its ends, as bands have them.
TEST_P(WalkedJobs, TakeTheSameWithAMemoryOfAnotherChip) {
  const Variants variants(resolve_platform(GetParam()));
  const ChipConfig base = variants.config({});
  for (const int workers : {base.cluster.workers, sim::Cluster::kMasterAlone}) {
    std::vector<Job> jobs;
    for (unsigned seed = 0; seed < 6; ++seed)
      jobs.push_back(random_job(base.cluster.workers, seed));
    soc::JobTimer first(base, workers);
    sim::TeamMemory memory(first.cluster());
    first.remember(&memory);
    for (const Job& job : jobs) first.front_end(job);
    for (const Parameter& parameter : variants.platform().parameters) {
      if (!parameter.range) continue;
      for (const double end : {parameter.range->low, parameter.range->high}) {
        const ChipConfig chip = variants.config({{parameter.path, end}});
        soc::JobTimer plain(chip, workers);
        soc::JobTimer recalling(chip, workers);
        recalling.recall(&memory);
        for (const Job& job : jobs)
          expect_equal(recalling.front_end(job), plain.front_end(job), parameter.path);
      }
    }
  }
}

/// Or nothing would be remembered at all.
TEST(TeamMemory, KnowsWhatDoesNotDependOnANumber) {
  const Variants variants(resolve_platform("gap9"));
  soc::JobTimer first(variants.config({}), 8);
  const sim::TeamMemory memory(first.cluster());
  const auto cluster = [&](const Change& change) {
    return soc::JobTimer(variants.config({change}), 8).cluster();
  };
  EXPECT_TRUE(memory.has_cores_of(cluster({"cluster.events.barrier", 5})));
  EXPECT_TRUE(memory.shares_as(cluster({"cluster.events.barrier", 5})));
  EXPECT_TRUE(memory.has_cores_of(cluster({"cluster.fpu.units", 8})));
  EXPECT_FALSE(memory.shares_as(cluster({"cluster.fpu.units", 8})));
  EXPECT_FALSE(memory.has_cores_of(cluster({"isa.unmeasured_instructions", 1.4})));
  EXPECT_TRUE(memory.shares_as(cluster({"isa.unmeasured_instructions", 1.4})));
  EXPECT_EQ(memory.operations_that_differ(cluster({"isa.ops.f32_div.stall", 30})),
            std::vector<std::size_t>{work::index(Op::F32Div)});
  EXPECT_EQ(memory.operations_that_differ(cluster({"isa.unmeasured_instructions", 1.4})),
            std::nullopt);
}

}  // namespace
}  // namespace leviosim::platform::testing
