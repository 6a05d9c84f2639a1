// Runs that are known from others are those of replay(), byte by byte, whatever of the chip
// differs.
#include "tools/app/run/known_runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/chip/same_cycles.h"
#include "sim/work/op.h"
#include "tests/tools/statistic_values.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {
namespace {

using work::Op;

constexpr int kCores = 4;
constexpr const char* kChip = "gap9";

work::Segment some_share(std::mt19937& random) {
  work::Segment work;
  for (const Op op : {Op::IntAlu, Op::F32Fma, Op::F32Div, Op::LoadIndexed, Op::LoadStream})
    work[op] = random() % (op == Op::F32Div ? 300 : 6'000);
  work.code[work::reuse_class(4'096)] = 4'000;
  return work;
}

/// Frames of two stages, of which some begin an optimisation that a slow chip does not end before
/// the next one. @param external  whether it moves data from external memory
traces::WorkTrace some_trace(bool external) {
  std::mt19937 random(7);
  traces::WorkTraceWriter writer(kCores);
  traces::WorkTraceInfo info;
  info.cores = kCores;
  info.image_width = 160;
  info.image_height = 120;
  info.frame_period_ns = 1'000'000;
  info.platform = kChip;
  info.platform_yaml = platform::to_yaml(platform::resolve_platform(kChip));
  info.stages = {
      {"features", "frame", false}, {"poses", "frame", false}, {"graph", "iteration", true}};
  for (int i = 0; i < 12; ++i) {
    traces::WorkFrame frame;
    frame.index = i;
    frame.t_ns = i * info.frame_period_ns;
    info.stamps_ns.push_back(frame.t_ns);
    frame.source = name_of(PoseSource::Epnp);
    std::vector<work::Segment> shares;
    for (int core = 0; core < kCores; ++core) shares.push_back(some_share(random));
    frame.front_end.stages.push_back(
        {"features",
         {work::Transfer{work::Direction::L2ToL1, Bytes(4'000)}, work::Serial{some_share(random)}},
         {Bytes(40'000), Bytes(40'000), {}}});
    frame.front_end.stages.push_back({"poses", {work::Fork{"poses", shares}}, {}});
    frame.optimised = i % 3 == 0;
    for (int k = 0; frame.optimised && k < 2; ++k) {
      std::vector<work::Step> steps{work::Serial{some_share(random)}};
      if (external) steps.emplace_back(work::Transfer{work::Direction::ExternalToL2, Bytes(900)});
      frame.iterations.push_back({{{"graph", std::move(steps), {}}}});
    }
    writer.add(frame);
  }
  return traces::WorkTrace("some", writer.finish(info));
}

std::string text_of(const Replay& replay) {
  std::string text = testing::figures_text(replay.run) + csv_text(frame_rows(replay.run)) +
                     csv_text(energy_rows(replay.run));
  for (const FrameComparison& f : replay.frames)
    text += fmt::format("{} {} {} {} {}\n", f.frame, f.replayed.waited_ns, f.replayed.seen,
                        f.replayed.optimised, f.replayed.optimiser_busy);
  return text;
}

/// What differs from the chip as it is; most of it changes no cycles.
std::vector<std::string> some_changes(std::mt19937& random) {
  const auto draw = [&](std::size_t n) { return random() % n; };
  const std::vector<std::vector<std::string>> all = {
      {"cluster.clock=185MHz", "controller.clock=185MHz"},
      {"cluster.clock=240MHz", "controller.clock=240MHz", "supply.voltage=0.65V"},
      {"cluster.clock=10MHz", "controller.clock=10MHz"},
      {"controller.clock=100MHz"},
      {"supply.voltage=0.8V"},
      {"cluster.l1.size=256KiB"},
      {"cluster.l1.size=32KiB"},
      {"l2.size=3MiB"},
      {"energy.core.instruction=9pJ"},
      {"energy.l1.access=2pJ"},
      {"area.core=50kGE"},
      {"cluster.fpu.units=2"},
      {"cluster.l1.banks=8"},
      {"cluster.dma.bytes_per_cycle=4"},
      {"cluster.events.barrier=30"},
      {"isa.unmeasured_instructions=1.5"},
      {"controller.external.latency=3us"}};
  std::vector<std::string> changes;
  for (std::size_t n = 1 + draw(2); n > 0; --n)
    for (const std::string& change : all[draw(all.size())]) changes.push_back(change);
  return changes;
}

TEST(KnownRuns, AreThoseOfReplayOnAnyPairOfChips) {
  const traces::WorkTrace plain = some_trace(false);
  const traces::WorkTrace external = some_trace(true);
  const auto progress = [](const Progress&) {};
  std::mt19937 random(11);
  std::size_t repeated = 0;
  std::size_t refused = 0;
  int pairs = 0;
  for (int k = 0; pairs < 200; ++k) {
    ASSERT_LT(k, 2'000);
    const traces::WorkTrace& trace = k % 2 == 0 ? plain : external;
    KnownRuns known;
    RunRequest request;
    request.cores = kCores;
    request.on_one_core = random() % 2 == 0;
    request.time_bands = random() % 4 == 0 ? TimeBandsOf::slowest_frame : TimeBandsOf::nothing;
    if (random() % 3 == 0) request.camera = soc::CameraRequest{{}, soc::Deadline::Drop};
    std::vector<std::string> changes;
    bool whole = true;
    for (int chip = 0; chip < 2 && whole; ++chip) {
      for (const std::string& change : some_changes(random)) changes.push_back(change);
      try {
        request.platform = platform::resolve_platform(kChip, changes);
      } catch (const InputError&) {
        whole = false;  // contradict each other
        continue;
      }
      std::string expected;
      std::string found;
      const auto text_or_failure = [&](const auto& run) {
        try {
          return text_of(run());
        } catch (const InputError& error) {
          ++refused;
          return std::string(error.what());
        }
      };
      expected = text_or_failure([&] { return replay(trace, request, progress); });
      found = text_or_failure([&] { return known.replay(trace, request, progress); });
      ASSERT_EQ(found, expected) << fmt::format("{}", fmt::join(changes, " "));
    }
    pairs += whole;
    repeated += known.repeated();
  }
  EXPECT_GT(repeated, 40u);
  EXPECT_GT(refused, 0u);
}

/// Else what a chip changes would be taken from another.
TEST(KnownRuns, TakesOtherCyclesFromNoChipThatDiffersInTiming) {
  const sim::ChipConfig base = platform::load_platform(kChip);
  const auto same = [&](const std::vector<std::string>& changes, bool external = true) {
    return sim::takes_same_cycles(base, platform::resolve_platform(kChip, changes).config,
                                  external);
  };
  EXPECT_TRUE(same({"cluster.l1.size=256KiB", "energy.core.instruction=9pJ"}));
  EXPECT_TRUE(same({"cluster.clock=185MHz", "controller.clock=185MHz"}, false));
  EXPECT_FALSE(same({"cluster.clock=185MHz", "controller.clock=185MHz"}, true));
  EXPECT_FALSE(same({"cluster.clock=185MHz"}, false));
  EXPECT_FALSE(same({"cluster.fpu.units=2"}));
  EXPECT_FALSE(same({"cluster.events.offload=10"}));
  EXPECT_FALSE(same({"cluster.dma.call=1"}));
}

}  // namespace
}  // namespace leviosim::tools
