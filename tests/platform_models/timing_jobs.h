// Small jobs with work of every kind, and how long a chip takes for them: for tests of what must
// hold on any chip, whatever its numbers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/chip/chip.h"
#include "sim/work/op.h"
#include "sim/work/program.h"

namespace leviosim::platform::testing {

using sim::ChipConfig;
using work::Counts;
using work::Job;
using work::Op;
using work::Segment;

/// Work with integers, floats, loads, branches and code, `scale` times as much of all of it. Which
/// kind dominates depends on `flavour`.
inline Segment some_work(std::uint64_t scale, std::uint64_t flavour = 0) {
  Segment work;
  for (const work::OpInfo& info : work::kOps) {
    if (info.op == Op::Straddle || info.op == Op::IntDivBits) continue;
    const std::uint64_t kind = work::index(info.op);
    work[info.op] = scale * (1 + (kind * 7 + flavour * 5) % 11);
  }
  work[Op::IntAlu] += 40 * scale;
  work.code[work::reuse_class(512)] = 16 * 30 * scale;
  work.code[work::reuse_class(4871)] = 16 * 20 * scale;
  work.code[work::reuse_class(16384)] = 16 * 3 * scale;
  work.code[work::kNeverFetched] = 16 * 100;
  return work;
}

/// Without code, whose misses are not proportional to anything.
inline Segment plain_work(std::uint64_t scale, std::uint64_t flavour = 0) {
  Segment work = some_work(scale, flavour);
  work.code = {};
  return work;
}

/// A chip's name in letters and digits, as GoogleTest wants it.
inline std::string name_of_test(const ::testing::TestParamInfo<std::string>& chip) {
  std::string name = chip.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

inline Segment only(Op op, std::uint64_t n) {
  Segment work;
  work[op] = n;
  return work;
}

inline work::Step serial(Segment work) { return work::Serial{std::move(work)}; }
inline work::Step fork(std::vector<Segment> shares) {
  return work::Fork{"fork", std::move(shares), false};
}
/// The same share for each worker.
inline work::Step team(int cores, const Segment& share) {
  return fork(std::vector<Segment>(static_cast<std::size_t>(cores), share));
}
inline work::Step transfer(std::int64_t bytes, bool background = false,
                           work::Direction direction = work::Direction::L2ToL1) {
  return work::Transfer{direction, Bytes(bytes), background};
}
inline work::Step wait_for(int number) { return work::TransferWait{number}; }

inline Job job_of(std::vector<work::Step> steps) {
  return {{work::StageRun{"stage", std::move(steps), {}}}};
}

inline sim::JobTiming timing_of(const ChipConfig& config, int workers, const Job& job,
                                bool keep_details = false) {
  sim::Chip chip(config, workers);
  chip.cluster().keep_steps(keep_details);
  chip.keep_forks(keep_details);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  return timing;
}

inline sim::JobTiming controlled(const ChipConfig& config, const Job& job) {
  sim::Chip chip(config, 1);
  chip.keep_forks(true);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.controller().run(job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  return timing;
}

inline std::int64_t sum_of_cycles(const sim::JobTiming& timing) {
  std::int64_t sum = 0;
  for (const sim::StageTiming& stage : timing.stages) sum += stage.cycles.count();
  return sum;
}
inline std::int64_t cycles(const ChipConfig& config, int workers, const Job& job) {
  return sum_of_cycles(timing_of(config, workers, job));
}
inline std::int64_t cycles(const ChipConfig& config, int workers, std::vector<work::Step> steps) {
  return cycles(config, workers, job_of(std::move(steps)));
}

}  // namespace leviosim::platform::testing
