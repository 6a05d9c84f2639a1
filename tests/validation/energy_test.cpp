// The energy model of GAP9 against published power (energy_reference.h).
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "platform_models/loader/loader.h"
#include "sim/chip/chip.h"
#include "sim/energy/model.h"
#include "sim/work/op.h"
#include "tests/validation/energy_reference.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/simulate.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::validation {
namespace {

using sim::Activity;
using sim::Domain;
using work::Counts;
using work::Op;

sim::ChipConfig gap9_at_370() { return platform::load_platform("gap9"); }
sim::ChipConfig gap9_at_240() {
  return platform::load_platform(
      "gap9", {"cluster.clock=240MHz", "controller.clock=240MHz", "supply.voltage=0.65V"});
}

/// Of one job with one stage.
sim::StageTiming time_of(const sim::ChipConfig& config, const work::Job& job) {
  sim::Chip chip(config, config.cluster.workers);
  sim::JobTiming timing;
  const auto body = [](sim::Chip& on, const work::Job& what, sim::JobTiming& out) -> sim::Process {
    out = co_await on.offload(what);
  };
  chip.kernel().spawn("job", body(chip, job, timing));
  chip.kernel().run();
  return timing.stages.at(0);
}

/// Eight workers that all do `share`, and how it went.
struct Load {
  Activity activity;
  double ipc;  ///< of a worker
};
Load eight_busy_cores(const sim::ChipConfig& config, const Counts& share) {
  work::StageRun stage{"load", {}, {}};
  stage.steps.emplace_back(work::Fork{"load", std::vector<work::Segment>(8, share)});
  const sim::StageTiming timing = time_of(config, {{stage}});
  const Activity activity =
      sim::cluster_activity(config, 8, work::counts_of(stage), work::transferred_by(stage),
                            timing.account.team, timing.cycles);
  return {activity, activity.instructions / 8 / static_cast<double>(timing.cycles.count())};
}

double mw(Joules energy, Seconds time) { return (energy / time).count() * 1e3; }

/// Integer work as of a cascade of rectangle features: of 100 instructions 30 loads, some of whose
/// values are awaited, and 8 taken branches.
Counts detector() {
  Counts counts;
  counts[Op::LoadStream] = 300'000;
  counts[Op::IntAlu] = 620'000;
  counts[Op::BranchTaken] = 80'000;
  return counts;
}

TEST(EnergyValidation, BusyCoresTakeWhatWasMeasuredForViolaJones) {
  const sim::ChipConfig chip = gap9_at_240();
  const Load load = eight_busy_cores(chip, detector());
  EXPECT_NEAR(load.ipc, 0.8, 0.03);
  EXPECT_NEAR(load.activity.l1_accesses / load.activity.instructions, 0.3, 1e-9);
  const sim::DomainEnergies energy = sim::energy_of(load.activity, chip);
  const auto domain = [&](Domain d) { return mw(energy[d].value, load.activity.time); };
  const double cluster = domain(Domain::Cores) + domain(Domain::Fpu) + domain(Domain::L1) +
                         domain(Domain::Dma) + domain(Domain::Cluster);
  const double total = mw(energy.total().value, load.activity.time);
  RecordProperty("cluster_mW", fmt::format("{:.2f}", cluster));
  RecordProperty("controller_l2_soc_regulator_mW", fmt::format("{:.2f}", total - cluster));
  RecordProperty("total_mW", fmt::format("{:.2f} ({:.2f} to {:.2f})", total,
                                         mw(energy.total().low(), load.activity.time),
                                         mw(energy.total().high(), load.activity.time)));
  // FACTS.md#energy-per-event counts 13 mW for the cluster and leaves 7.5 mW for controller, L2,
  // instruction caches and regulator; the model puts 3.3 mW there, and says itself how little it
  // knows of them.
  EXPECT_NEAR(cluster, 13, 1);
  EXPECT_NEAR(total - cluster, 3.3, 0.3);
  EXPECT_LT(mw(energy.total().low(), load.activity.time), kViolaJones_mW);
  EXPECT_GT(mw(energy.total().high(), load.activity.time), kViolaJones_mW);
  EXPECT_NEAR(total, kViolaJones_mW, 0.3 * kViolaJones_mW);
}

/// Dense single-precision work on all cores, with the controller as busy as one of them.
double full_load_mw(const sim::ChipConfig& chip) {
  Counts share;
  share[Op::LoadStream] = 350'000;
  share[Op::F32Fma] = 250'000;
  share[Op::IntAlu] = 350'000;
  share[Op::BranchTaken] = 20'000;
  const Load load = eight_busy_cores(chip, share);
  EXPECT_GT(load.ipc, 0.8);
  const double controller_cycles =
      load.activity.time.count() * static_cast<double>(chip.controller.clock.count());
  Counts own;
  own[Op::LoadIndexed] = static_cast<std::uint64_t>(0.15 * controller_cycles);
  own[Op::F32Fma] = own[Op::IntAlu] = static_cast<std::uint64_t>(0.3 * controller_cycles);
  sim::DomainEnergies energy = sim::energy_of(load.activity, chip);
  energy += sim::energy_of(
      sim::controller_activity(chip, own, {}, Cycles(std::llround(controller_cycles))), chip);
  return mw(energy.total().value, load.activity.time);
}

TEST(EnergyValidation, FullLoadIsWithinTheMlperfEnvelopeAtBothPoints) {
  const double slow = full_load_mw(gap9_at_240());
  const double fast = full_load_mw(gap9_at_370());
  RecordProperty("at_240_mW", fmt::format("{:.2f}", slow));
  RecordProperty("at_370_mW", fmt::format("{:.2f}", fast));
  const auto within = [](double power, double MlperfTask::*at) {
    const auto [least, most] = std::minmax_element(
        kMlperf.begin(), kMlperf.end(),
        [at](const MlperfTask& a, const MlperfTask& b) { return a.*at < b.*at; });
    EXPECT_GE(power, (*least).*at);
    EXPECT_LE(power, (*most).*at);
  };
  within(slow, &MlperfTask::mw_at_240);
  within(fast, &MlperfTask::mw_at_370);
  // Solved for a and s as the tasks were.
  const double dynamic = 0.80 * 0.80 * 370 - 0.65 * 0.65 * 240 * (0.80 / 0.65);
  const double a = (fast - slow * (0.80 / 0.65)) / dynamic;
  const double static_mw = slow - a * 0.65 * 0.65 * 240;
  RecordProperty("a", fmt::format("{:.3f}", a));
  RecordProperty("static_mW", fmt::format("{:.2f}", static_mw));
  EXPECT_GE(a, kLeastA);
  EXPECT_LE(a, kMostA);
  EXPECT_GE(static_mw, kLeastStatic_mW);
  EXPECT_LE(static_mw, kMostStatic_mW);
}

/// LEVIO over three seconds of synthetic flight, at both points.
class LevioEnergy : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    flight() = std::filesystem::temp_directory_path() /
               fmt::format("leviosim-{}-energy-flight", ::getpid());
    traces::write_synthetic_flight(flight(), {.duration_s = 3, .texel_m = 0.01});
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(flight()); }

  static tools::RunResult run(const std::vector<std::string>& overrides) {
    tools::RunRequest request;
    request.data = flight();
    request.platform = platform::resolve_platform("gap9", overrides);
    return tools::simulate(request, [](const tools::Progress&) {});
  }

 private:
  static std::filesystem::path& flight() {
    static std::filesystem::path folder;
    return folder;
  }
};

TEST_F(LevioEnergy, At370MegahertzIsFarBelowTheClaimAndNearWhatWasExpected) {
  const tools::RunEnergy energy = tools::energy_of(run({})).value();
  const auto front_end = energy.power_of_front_end().value();
  const auto optimiser = energy.power_of_controller().value();
  sim::Estimate<Watts> both = front_end;
  both += optimiser;
  RecordProperty("front_end_mW", fmt::format("{:.1f}", front_end.value.count() * 1e3));
  RecordProperty("with_optimiser_mW", fmt::format("{:.1f}", both.value.count() * 1e3));
  EXPECT_LT(both.high().count() * 1e3, kLevioClaim_mW);
  // Cores that wait for code draw less: the high end lies 1 % below what was expected at least.
  EXPECT_GT(both.high().count() * 1e3, 0.98 * kLevioExpectedLow_mW);
  EXPECT_LT(both.low().count() * 1e3, kLevioExpectedHigh_mW);
}

// The paper: throughput scales with the clock, and a lower clock minimises dynamic power.
TEST_F(LevioEnergy, TimeScalesWithTheClockAndEnergyFallsWithTheVoltage) {
  const tools::RunResult fast = run({});
  const tools::RunResult slow =
      run({"cluster.clock=240MHz", "controller.clock=240MHz", "supply.voltage=0.65V"});
  const auto duration = [](const tools::FrameResult& f) {
    return static_cast<double>(f.end_ns - f.start_ns);
  };
  EXPECT_EQ(fast.frames[1].cycles, slow.frames[1].cycles);
  EXPECT_NEAR(duration(slow.frames[1]) / duration(fast.frames[1]), 370.0 / 240.0, 1e-4);

  const tools::RunEnergy at_370 = tools::energy_of(fast).value();
  const tools::RunEnergy at_240 = tools::energy_of(slow).value();
  const auto joules = [](const tools::RunEnergy& e) { return e.per_frame()->value.count(); };
  EXPECT_LT(joules(at_240), joules(at_370));
  EXPECT_GT(joules(at_240), joules(at_370) * 0.65 * 0.65 / (0.8 * 0.8) * 0.8);
  EXPECT_LT(at_240.mean_power()->value, at_370.mean_power()->value);
}

}  // namespace
}  // namespace leviosim::validation
