// `next-loop` on drawn flights: nothing changes until a loop is closed, loops are closed, and all
// of it fits its memory and the time between frames.
#include <gtest/gtest.h>

#include <algorithm>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/soc/job_timer.h"
#include "sim/work/machine.h"
#include "tests/workload/short_flight.h"
#include "workload/next/loop/loop_closer.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using vio::test::Flown;
using vio::test::ShortFlight;

/// Through the middle of the room, again and again.
const ShortFlight& rounds() {
  static const ShortFlight flight =
      vio::test::draw_flight(vio::test::PacedFlight(3, vio::test::at_pace(1.2)), 20);
  return flight;
}

TEST(NextLoop, IsNextUntilALoopIsClosed) {
  const ShortFlight flight =
      vio::test::draw_flight(vio::test::PacedFlight(3, vio::test::at_pace(1.2)), 6);
  const Flown next = vio::test::fly(flight, vio::profile_named("next", 1));
  const Flown loop = vio::test::fly(flight, vio::profile_named("next-loop", 1));
  ASSERT_EQ(next.trajectory.size(), loop.trajectory.size());
  for (std::size_t i = 0; i < next.trajectory.size(); ++i)
    EXPECT_EQ(next.trajectory[i].T_world_body.matrix(), loop.trajectory[i].T_world_body.matrix())
        << i;
}

/// A flight that drifts by less than a view tells its place has nothing to gain from a closure.
TEST(NextLoop, ClosesLoopsAndIsNoWorseForIt) {
  constexpr double kPlace = 0.05;  // m, of a view of 160×120 px (ACCURACY.md)
  const Flown next = vio::test::fly(rounds(), vio::profile_named("next", 1));
  const Flown loop = vio::test::fly(rounds(), vio::profile_named("next-loop", 1));
  EXPECT_NE(next.trajectory.back().T_world_body.matrix(),
            loop.trajectory.back().T_world_body.matrix());
  EXPECT_TRUE(loop.finite);
  EXPECT_LT(loop.skew, 1e-5);
  EXPECT_LT(loop.ate, std::max(1.05 * next.ate, kPlace));
}

constexpr double kCyclesPerMs = 370e3;

/// What loop closure takes of a frame.
double loop_ms(const sim::JobTiming& timing) {
  double ms = 0;
  for (const sim::StageTiming& stage : timing.stages)
    if (stage.stage == vio::stages::kPlaceRecognition ||
        stage.stage == vio::stages::kLoopVerification ||
        stage.stage == vio::stages::kLoopCorrection)
      ms += static_cast<double>(stage.cycles.count()) / kCyclesPerMs;
  return ms;
}

/// On all frames and in the longest, on GAP9 at 370 MHz.
TEST(NextLoop, StaysWithinItsTimeAndMemory) {
  const sim::ChipConfig chip = platform::load_platform("gap9");
  const vio::Profile profile = vio::profile_named("next-loop", 1);
  work::Machine cluster({.cores = 8,
                         .capacity = chip.cluster.l1.size,
                         .alignment = profile.l1_alignment,
                         .record = true,
                         .code = &platform::compiled_code()});
  work::Machine controller({1, "L2", chip.l2.size, 4, false});
  const auto odometry = vio::make_odometry(true, profile, rounds().rig, cluster, controller);
  EXPECT_LE(odometry->loop_memory().used().count(), 256'000);
  soc::JobTimer timer(chip, 8);
  double sum_ms = 0, worst_ms = 0;
  int frames = 0, closures = 0;
  std::int64_t before_ns = rounds().frames.front().t_ns;
  for (const ShortFlight::Frame& frame : rounds().frames) {
    const auto dt = static_cast<float>(static_cast<double>(frame.t_ns - before_ns) * 1e-9);
    before_ns = frame.t_ns;
    const bool optimises = odometry->begin_optimisation();
    closures += odometry
                    ->process_frame({frame.pixels.data(), rounds().rig.width, rounds().rig.height,
                                     dt, frame.imu})
                    .loop_closures;
    for (int k = 0; optimises && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimises) odometry->publish();
    const double ms = loop_ms(timer.front_end(cluster.take_job()));
    controller.take_job();
    sum_ms += ms;
    worst_ms = std::max(worst_ms, ms);
    ++frames;
  }
  EXPECT_GT(closures, 0);
  EXPECT_LT(sum_ms / frames, 3);
  EXPECT_LT(worst_ms, 15);
}

}  // namespace
}  // namespace leviosim::tools
