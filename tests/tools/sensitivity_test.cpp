// Sweeps over tiny jobs whose times are closed formulas.
#include "tools/app/study/sensitivity/sensitivity.h"
#include "sim/work/op.h"
#include "tools/app/study/sensitivity/sensitivity_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "platform_models/loader/loader.h"
#include "sim/soc/job_timer.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/range_bands.h"
#include "tools/app/run/time_bands.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {
namespace {

using work::Op;

constexpr double kMsPerCycle = 1e3 / 370e6;

work::Job job_of(std::string_view stage, std::vector<work::Step> steps) {
  work::Job job;
  job.stages.push_back({stage, std::move(steps), {}});
  return job;
}

work::Serial serial(Op op, std::uint64_t n) {
  work::Counts counts;
  counts[op] = n;
  return {counts};
}

/// 10'000 integer operations with EPnP, a transfer of 8'000 bytes with 8-point, and an optimiser of
/// 1'000 calls.
traces::WorkTrace example() {
  traces::WorkTraceWriter writer(1);
  traces::WorkFrame frame;
  const auto add = [&](PoseSource source, const work::Job& job) {
    frame.t_ns += 50'000'000;
    frame.source = name_of(source);
    frame.front_end = job;
    writer.add(frame);
  };
  add(PoseSource::First, job_of("start", {serial(Op::IntAlu, 1'000'000)}));
  add(PoseSource::Epnp, job_of("e", {serial(Op::IntAlu, 10'000)}));
  frame.optimised = true;
  frame.iterations = {job_of("o", {serial(Op::Call, 1'000)})};
  add(PoseSource::EightPoint, job_of("m", {work::Transfer{work::Direction::L2ToL1, Bytes(8'000)}}));
  return traces::WorkTrace("example", writer.finish({}));
}

traces::WorkTrace nothing() {
  return traces::WorkTrace("nothing", traces::WorkTraceWriter(1).finish({}));
}

platform::Variants gap9() { return platform::Variants(platform::resolve_platform("gap9")); }

Sensitivity sweep(unsigned threads = 1) {
  return sensitivity(gap9(), 8, example(), {.threads = threads});
}

const Swing& swing(const Sensitivity& s, const std::string& path) {
  const auto it = std::find_if(s.swings.begin(), s.swings.end(),
                               [&](const Swing& w) { return w.parameter.path == path; });
  EXPECT_NE(it, s.swings.end()) << path;
  return *it;
}

constexpr double kOffloads = 2 * 300;  // there and back

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("{}", fmt::join(parts, ""));
}

TEST(Sensitivity, TheBaseIsWhatTheJobsTake) {
  const MeanTimes base = time_on(gap9().config({}), 8, example());
  EXPECT_NEAR(base.epnp.value(), (10'000 + kOffloads) * kMsPerCycle, 1e-9);
  // programming 20, first data 16, 8 bytes per cycle, completion 8
  EXPECT_NEAR(base.eight_point.value(), (20 + 16 + 1'000 + 8 + kOffloads) * kMsPerCycle, 1e-9);
  EXPECT_NEAR(base.frame.value(), (base.epnp.value() + base.eight_point.value()) / 2, 1e-9);
  EXPECT_NEAR(base.iteration.value(), 1'000 * (12 + 2) * kMsPerCycle, 1e-9);
}

TEST(Sensitivity, BothEndsOfARangeFollowTheFormula) {
  const Sensitivity s = sweep();
  const Swing& factor = swing(s, "isa.unmeasured_instructions");  // 0.86 to 1.6
  EXPECT_NEAR(factor.low.epnp.value(), (8'600 + kOffloads) * kMsPerCycle, 1e-9);
  EXPECT_NEAR(factor.high.epnp.value(), (16'000 + kOffloads) * kMsPerCycle, 1e-9);
  EXPECT_EQ(factor.high.eight_point, s.base.eight_point);
  EXPECT_NEAR(factor.high.iteration.value(), 1'000 * (1.6 * 12 + 2) * kMsPerCycle, 1e-9);
  const Swing& rate = swing(s, "cluster.dma.bytes_per_cycle");  // 4 to 8
  EXPECT_NEAR(rate.low.eight_point.value() - s.base.eight_point.value(), 1'000 * kMsPerCycle, 1e-9);
  EXPECT_EQ(rate.high.eight_point, s.base.eight_point);
  const Swing& call = swing(s, "isa.ops.call.issue");  // 2 to 30
  EXPECT_NEAR(percent_change(call.low.iteration, s.base.iteration).value(), -100 * 10.0 / (12 + 2),
              1e-9);
  EXPECT_EQ(effect_on_frame(call, s.base), 0);
}

TEST(Sensitivity, BandsOfStagesAreRootsOfSumsOfSquares) {
  const Sensitivity s = sweep();
  const std::vector<StageBand> bands = stage_bands(s);
  ASSERT_EQ(bands.size(), 3u);  // e, o, m
  EXPECT_EQ(bands[0].stage, "e");
  EXPECT_NEAR(bands[0].kcycles.value, 10, 1e-3);  // whole cycles
  const auto unmeasured = gap9().find("isa.unmeasured_instructions")->range;
  EXPECT_NEAR(bands[0].kcycles.low, 10 * unmeasured->low, 2e-3);
  EXPECT_NEAR(bands[0].kcycles.high, 10 * unmeasured->high, 2e-3);
  // Of the transfer: bytes per cycle 4 … 8, programming 10 … 30, first data 10 … 30, completion
  // 4 … 12. The rest of the call of the API is over long before.
  const double slow = 1.0, programming = 0.01, later = 0.014, earlier = 0.006, completion = 0.004;
  EXPECT_NEAR(bands[2].kcycles.value, 1.044, 1e-9);
  EXPECT_NEAR(bands[2].kcycles.high,
              1.044 + std::hypot(std::hypot(slow, later), std::hypot(programming, completion)),
              1e-9);
  EXPECT_NEAR(bands[2].kcycles.low, 1.044 - std::hypot(programming, earlier, completion), 1e-9);
  EXPECT_NE(joined(sensitivity_tables(s, 8)).find("if all these numbers are uncertain"),
            std::string::npos);
}

/// A sample that holds all jobs has the bands of the sweep over all.
TEST(Sensitivity, BandsOfASampleAreThoseOfTheSweep) {
  JobSample sample;
  sample.add_frame(job_of("m", {work::Transfer{work::Direction::L2ToL1, Bytes(8'000)}}),
                   Cycles(1'662));
  sample.add_frame(job_of("e", {serial(Op::IntAlu, 10'000)}), Cycles(10'900));
  const platform::ResolvedPlatform chip = platform::resolve_platform("gap9");
  const TimeBands bands = time_bands(chip, 8, sample, TimeBandsOf::team_and_one_core, 2);
  ASSERT_EQ(bands.stages.size(), 2u);  // m, e
  const Banded transfer = stage_bands(sweep())[2].kcycles;
  EXPECT_NEAR(bands.stages[0].parallel.low, transfer.low / transfer.value, 1e-9);
  EXPECT_NEAR(bands.stages[0].parallel.high, transfer.high / transfer.value, 1e-9);
  EXPECT_NEAR(bands.stages[0].single.high, bands.stages[0].parallel.high, 1e-9);
  const auto unmeasured = gap9().find("isa.unmeasured_instructions")->range;
  EXPECT_NEAR(bands.stages[1].parallel.low, unmeasured->low, 1e-3);
  EXPECT_NEAR(bands.stages[1].parallel.high, unmeasured->high, 1e-3);
  // Offloading takes 150 to 1500 cycles each way, whatever the slowest frame does.
  const double cycles = 10'000 + kOffloads;
  EXPECT_NEAR(bands.slowest.high,
              1 + std::hypot((unmeasured->high - 1) * 10'000, 2 * 1'200) / cycles, 1e-3);
  const TimeBands slowest = time_bands(chip, 8, sample, TimeBandsOf::slowest_frame);
  EXPECT_EQ(slowest.slowest.high, bands.slowest.high);
}

/// Code that was measured has the band of what other compilers make of it.
TEST(Sensitivity, BandsOfMeasuredCodeAreThoseOfOtherCompilers) {
  work::Segment segment;
  segment[Op::IntAlu] = 10'000;
  work::CompiledWork compiled{};
  compiled[static_cast<std::size_t>(work::Compiled::Executed)] = 1'600;
  compiled[static_cast<std::size_t>(work::Compiled::Priced)] = 1'600;
  const platform::ResolvedPlatform chip = platform::resolve_platform("gap9");
  work::set_compiled(segment.compiled, chip.config.cluster.core.code, compiled);
  JobSample sample;
  sample.add_frame(job_of("e", {work::Serial{segment}}), Cycles(10'000));
  const TimeBands bands = time_bands(chip, 8, sample, TimeBandsOf::team_and_one_core, 1);
  EXPECT_NEAR(bands.stages[0].parallel.low, kOtherCompilers.low, 1e-3);
  EXPECT_NEAR(bands.stages[0].parallel.high, kOtherCompilers.high, 1e-3);
}

/// A RANSAC: hypotheses of differing length and mix, each followed by a piece of serial work or by
/// the next at once, and a count of inliers at the end.
work::Job hypotheses(unsigned seed) {
  std::mt19937 random(seed);
  const auto share = [&] {
    work::Segment work;
    for (const Op op : {Op::IntAlu, Op::F32Fma, Op::F32Div, Op::LoadIndexed, Op::LoadStream})
      work[op] = random() % (op == Op::F32Div ? 60 : 1'500);
    work.code[work::reuse_class(4'096)] = 4'000;
    return work;
  };
  std::vector<work::Step> steps;
  for (int k = 0; k < 40; ++k) {
    std::vector<work::Segment> shares;
    for (int core = 0; core < 8; ++core) shares.push_back(share());
    steps.emplace_back(work::Fork{"hypotheses", std::move(shares)});
    if (k % 4 == 3) steps.emplace_back(serial(Op::IntAlu, 200 + random() % 400));
  }
  std::vector<work::Segment> shares(8);
  for (work::Segment& work : shares) work[Op::F32Fma] = 40'000;
  steps.emplace_back(work::Fork{"inliers", std::move(shares)});
  return job_of("ransac", std::move(steps));
}

/// Of forks that are alike, a few are timed for bands: within a twentieth of the bands' width they
/// are those of all forks.
TEST(Sensitivity, BandsOfManyForksAreThoseOfAFewOfThem) {
  const platform::ResolvedPlatform chip = platform::resolve_platform("gap9");
  for (const unsigned seed : {1u, 2u, 3u}) {
    const work::Job job = hypotheses(seed);
    JobSample sample;
    sample.add_frame(job, Cycles(1));
    const TimeBands bands = time_bands(chip, 8, sample, TimeBandsOf::team, 2);
    const std::vector<Banded> all = range_bands(
        platform::Variants(chip),
        [&](const sim::ChipConfig& config) {
          soc::JobTimer timer(config, 8);
          const sim::JobTiming timing = timer.front_end(job);
          return std::vector<double>{static_cast<double>(timer.front_end_cycles(timing).count()),
                                     static_cast<double>(timing.stages.front().cycles.count())};
        },
        2);
    const auto expect_near = [&](const Banded& some, const Banded& whole) {
      const double low = whole.low / whole.value, high = whole.high / whole.value;
      EXPECT_NEAR(some.low, low, 0.05 * (high - low)) << seed;
      EXPECT_NEAR(some.high, high, 0.05 * (high - low)) << seed;
    };
    expect_near(bands.slowest, all[0]);
    expect_near(bands.stages.at(0).parallel, all[1]);
  }
}

TEST(JobSample, HoldsTheSlowestAndSomeOfAllTheRun) {
  JobSample sample;
  for (int i = 0; i < 100; ++i)
    sample.add_frame(job_of("e", {serial(Op::IntAlu, static_cast<std::uint64_t>(i))}),
                     Cycles(i == 37 ? 1'000 : 10));
  EXPECT_EQ(work::counts_of(sample.slowest().stages[0])[Op::IntAlu], 37u);
  std::vector<std::uint64_t> kept;
  for (const work::Job& job : sample.spread())
    kept.push_back(work::counts_of(job.stages[0])[Op::IntAlu]);
  EXPECT_EQ(kept, (std::vector<std::uint64_t>{31, 63, 95}));
}

TEST(Sensitivity, TheLargestEffectOnTheFrameComesFirst) {
  const Sensitivity s = sweep();
  EXPECT_EQ(s.swings[0].parameter.path, "isa.unmeasured_instructions");
  EXPECT_EQ(s.swings[1].parameter.path, "cluster.events.offload");
  for (std::size_t i = 1; i < s.swings.size(); ++i)
    EXPECT_GE(effect_on_frame(s.swings[i - 1], s.base), effect_on_frame(s.swings[i], s.base));
}

TEST(Sensitivity, CoversEveryNumberThatHasARange) {
  const platform::ResolvedPlatform platform = platform::resolve_platform("gap9");
  const auto ranges = std::count_if(
      platform.parameters.begin(), platform.parameters.end(), [](const platform::Parameter& p) {
        return p.range.has_value() && p.path.rfind("energy.", 0) != 0 &&
               p.path.rfind("supply.", 0) != 0 && p.path.rfind("area.", 0) != 0;
      });
  const Sensitivity s = sweep();
  EXPECT_EQ(s.swings.size(), static_cast<std::size_t>(ranges));
}

TEST(Sensitivity, NamesUncertainNumbersWithoutARange) {
  const platform::Variants platform(
      platform::resolve_platform("gap9", {"isa.load_use_fraction=0.3"}));
  const Sensitivity s = sensitivity(platform, 8, nothing(), {.threads = 1});
  EXPECT_EQ(std::count(s.unbounded.begin(), s.unbounded.end(), "isa.load_use_fraction"), 1);
  EXPECT_NE(joined(sensitivity_tables(s, 8)).find("without a range"), std::string::npos);
}

TEST(Sensitivity, DoesNotDependOnTheHostsThreads) {
  EXPECT_EQ(csv_text(sensitivity_rows(sweep(1))), csv_text(sensitivity_rows(sweep(4))));
}

TEST(Sensitivity, WhatARunDoesNotHaveIsAbsent) {
  const Sensitivity s = sensitivity(gap9(), 8, nothing(), {.threads = 2});
  EXPECT_FALSE(s.base.frame.has_value());
  EXPECT_FALSE(percent_change(s.swings[0].low.frame, s.base.frame).has_value());
  EXPECT_NE(joined(sensitivity_tables(s, 8)).find("front end – on 8 cores"), std::string::npos);
}

TEST(Sensitivity, TableAndFileShowTheEffect) {
  const Sensitivity s = sweep();
  const std::string text = joined(sensitivity_tables(s, 8));
  const std::string effect =
      fmt::format("{:+.2f} … {:+.2f}", 100 * 10'000 * (0.86 - 1) / (10'000 + kOffloads),
                  100 * 10'000 * (1.6 - 1) / (10'000 + kOffloads));
  EXPECT_NE(text.find(effect), std::string::npos) << effect << '\n' << text;
  EXPECT_NE(text.find("changing nothing"), std::string::npos);
  const std::string csv = csv_text(sensitivity_rows(s));
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            s.swings.size() + 1);
  EXPECT_NE(csv.find("isa.unmeasured_instructions,low,ratio,1,0.86,1.6,"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
