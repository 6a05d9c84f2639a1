// What a closed loop loses, delays and publishes: formulas for work of constant length, then whole
// flights.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <optional>

#include "platform_models/loader/loader.h"
#include "tests/tools/constant_source.h"
#include "tests/tools/example_run.h"
#include "tests/tools/statistic_values.h"
#include "tests/traces/test_folder.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/tables.h"
#include "tools/app/result/camera_figures.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/run/feed.h"
#include "tools/app/run/live_source.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::ConstantWork;
using testing::length_ns;
using testing::LoopRun;
using testing::run_loop;
using traces::testing::AslFolder;
using traces::testing::expect_input_error;

constexpr std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

std::vector<int> processed(const LoopRun& run) {
  std::vector<int> frames;
  for (const FrameResult& frame : run.result.frames) frames.push_back(frame.index);
  return frames;
}

/// Periods that are shorter and longer than the work, by a nanosecond too.
std::vector<std::int64_t> periods(std::int64_t length) {
  return {2 * length,     length + 1, length,         length - 1, length * 2 / 3,
          length / 2 + 1, length / 2, length / 2 - 1, length / 3, length * 2 / 7};
}

TEST(ClosedLoop, DropsAllFramesThatComeWhileOneIsWorkedOn) {
  ConstantWork work;
  const std::int64_t length = length_ns(work);
  for (const std::int64_t period : periods(length)) {
    work.period_ns = period;
    const LoopRun run = run_loop(work, Deadline::Drop);
    const std::int64_t every = ceil_div(length, period);
    std::vector<int> expected;
    for (int i = 0; i < work.frames; i += static_cast<int>(every)) expected.push_back(i);
    EXPECT_EQ(processed(run), expected) << period;
    const CameraFigures figures = camera_figures(run.result).value();
    EXPECT_EQ(figures.arrived, work.frames);
    EXPECT_EQ(figures.dropped, work.frames - static_cast<std::int64_t>(expected.size())) << period;
    EXPECT_EQ(figures.late, length > period ? figures.processed : 0) << period;
    EXPECT_EQ(figures.waited, 0) << period;
    EXPECT_EQ(figures.latency.p50_ns, length);
    EXPECT_EQ(figures.latency.max_ns, length);
  }
}

/// A workload whose third pose is no number.
class DivergingSource : public testing::ConstantSource {
 public:
  using ConstantSource::ConstantSource;
  const work::Job& process(FrameResult& result) override {
    const work::Job& job = ConstantSource::process(result);
    if (result.index == 2) result.pose.T_world_body.translation().y() = std::nan("");
    return job;
  }
};

TEST(ClosedLoop, APoseThatIsNoNumberReachesNoTrajectory) {
  for (const std::optional<Deadline> deadline : {std::optional<Deadline>(), {Deadline::Drop}}) {
    DivergingSource source({.frames = 5});
    const RunRequest request = testing::request_at(Hertz(100'000'000), deadline);
    const RunResult result = simulate_source(request, source, [](const Progress&) {});
    EXPECT_EQ(result.frames.size(), 5u);
    EXPECT_EQ(result.trajectory.size(), 4u);
    EXPECT_EQ(result.poses_left_out, 1);
  }
}

TEST(ClosedLoop, AQueueHoldsOneFrameAndLosesTheNext) {
  ConstantWork work;
  const std::int64_t length = length_ns(work);
  for (const std::int64_t period : periods(length)) {
    if (period >= length) continue;
    work.period_ns = period;
    const LoopRun run = run_loop(work, Deadline::Queue);
    // The front end never rests: the k-th frame starts at k lengths. The one after it is the first
    // to come when the buffer is free again.
    std::vector<int> expected{0, 1};
    for (std::int64_t k = 1; ceil_div(k * length, period) < work.frames; ++k)
      expected.push_back(static_cast<int>(ceil_div(k * length, period)));
    EXPECT_EQ(processed(run), expected) << period;
    for (std::size_t k = 0; k < run.result.frames.size(); ++k) {
      const FrameResult& frame = run.result.frames[k];
      EXPECT_EQ(frame.start_ns, static_cast<std::int64_t>(k) * length) << period;
      EXPECT_EQ(frame.end_ns - frame.start_ns, length);
    }
    const CameraFigures figures = camera_figures(run.result).value();
    EXPECT_EQ(figures.most_found, figures.dropped > 0 ? 2 : 1) << period;
    EXPECT_EQ(figures.arrived, figures.processed + figures.dropped);
    EXPECT_LE(figures.latency.max_ns, 2 * length);
  }
}

TEST(ClosedLoop, TakesAndLosesNothingOnAChipThatKeepsUp) {
  ConstantWork work;
  work.iteration = 2'000;
  work.period_ns = length_ns(work);
  const LoopRun open = run_loop(work, {});
  EXPECT_FALSE(open.result.camera);
  for (const Deadline deadline : {Deadline::Drop, Deadline::Queue}) {
    const LoopRun closed = run_loop(work, deadline);
    EXPECT_EQ(processed(closed), processed(open));
    EXPECT_EQ(camera_figures(closed.result)->missed(), 0);
    for (std::size_t i = 0; i < open.starts.size(); ++i) {
      EXPECT_EQ(closed.starts[i].start_ns, open.starts[i].start_ns);
      EXPECT_EQ(closed.starts[i].seen, open.starts[i].seen);
    }
  }
}

TEST(ClosedLoop, ResultsOfTheOptimiserAreSeenByFramesTakenUpAfterItIsDone) {
  ConstantWork work;
  const std::int64_t length = length_ns(work);
  work.period_ns = length + 500;
  // Three iterations of 10 ns cycles take a little more than two and a half periods.
  work.iteration = static_cast<std::uint64_t>(work.period_ns) * 5 / 2 / 3 / 10;
  for (const soc::FrameStart& start : run_loop(work, Deadline::Drop).starts) {
    const int begun = start.frame / 3 * 3;
    EXPECT_EQ(start.optimiser_busy, start.frame != begun) << start.frame;
    EXPECT_EQ(start.seen, start.frame < 3 ? -1 : begun - 3) << start.frame;
  }
  // At twice the clock of the work, every second frame is dropped and the optimiser keeps its pace.
  work.period_ns = length * 3 / 5;
  work.iteration = static_cast<std::uint64_t>(length) * 5 / 2 / 3 / 10;
  const LoopRun slow = run_loop(work, Deadline::Drop);
  for (const soc::FrameStart& start : slow.starts) {
    EXPECT_EQ(start.frame % 2, 0);
    EXPECT_EQ(start.optimiser_busy, start.frame / 2 % 3 != 0) << start.frame;
  }
}

TEST(ClosedLoop, ASlowerClockNeverMissesFewerFramesOfConstantWork) {
  ConstantWork work;
  work.period_ns = 70'000;
  for (const Deadline deadline : {Deadline::Drop, Deadline::Queue}) {
    std::int64_t missed = work.frames;
    std::int64_t dropped = work.frames;
    for (std::int64_t mhz = 20; mhz <= 400; mhz += 20) {
      const RunResult run = run_loop(work, deadline, Hertz(mhz * 1'000'000)).result;
      const CameraFigures figures = camera_figures(run).value();
      EXPECT_LE(figures.missed(), missed) << mhz;
      EXPECT_LE(figures.dropped, dropped) << mhz;
      missed = figures.missed();
      dropped = figures.dropped;
    }
    EXPECT_EQ(missed, 0);
  }
}

TEST(Camera, TakesEvenlyFromTheRecordingByTheRatioOfTheRates) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 12; ++i) stamps.push_back(5'000'000'000 + 50'000'000 * i);
  const auto recorded = [&](double fps) {
    std::vector<std::size_t> numbers;
    for (const soc::CameraFrame& frame : soc::frames_at(fps, stamps, 20))
      numbers.push_back(frame.recorded);
    return numbers;
  };
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(recorded(20).size(), 12u);
  EXPECT_EQ(recorded(10), (Numbers{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(recorded(15), (Numbers{0, 1, 3, 4, 5, 7, 8, 9, 11}));
  EXPECT_EQ(recorded(8), (Numbers{0, 3, 5, 8, 10}));
  EXPECT_EQ(recorded(0.1), (Numbers{0}));
  const std::vector<soc::CameraFrame> frames = soc::frames_at(15, stamps, 20);
  for (std::size_t k = 0; k < frames.size(); ++k)
    EXPECT_NEAR(static_cast<double>(frames[k].arrival_ns), static_cast<double>(k) * 1e9 / 15, 1);
  expect_input_error([&] { soc::frames_at(25, stamps, 20); },
                     {"25 frames/s", "recorded at 20 frames/s", "at most 20"});
}

TEST(Camera, KeepsTheStampsOfTheRecordingAtItsRate) {
  const std::vector<std::int64_t> stamps{100, 150'000'100, 200'000'000, 250'000'007};
  const std::vector<soc::CameraFrame> all = soc::all_frames(stamps);
  const std::vector<soc::CameraFrame> same = soc::frames_at(20, stamps, 20);
  ASSERT_EQ(same.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(same[i].recorded, i);
    EXPECT_EQ(same[i].arrival_ns, all[i].arrival_ns);
    EXPECT_EQ(all[i].arrival_ns, stamps[i] - 100);
  }
}

TEST(Camera, PoliciesAreKnownByName) {
  EXPECT_EQ(soc::parse_deadline("drop"), Deadline::Drop);
  EXPECT_EQ(soc::parse_deadline("queue"), Deadline::Queue);
  expect_input_error([] { soc::parse_deadline("quue"); },
                     {"--deadline 'quue'", "drop or queue", "did you mean 'queue'"});
}

TEST(Feed, IntegratesTheSamplesOfDroppedFramesToo) {
  const AslFolder data;
  RunRequest request;
  request.data = data.root();
  request.image_size = {32, 24};
  const auto integrated = [&](const std::vector<int>& frames) {
    Feed feed(request);
    double seconds = 0;
    std::size_t samples = 0;
    for (const int frame : frames) {
      const vio::FrameInput& input = feed.frame(frame);
      if (frame == 0) continue;  // whose batch reaches back before the flight
      samples += input.imu.size();
      for (const vio::ImuInput& sample : input.imu) seconds += static_cast<double>(sample.dt);
      EXPECT_NEAR(static_cast<double>(input.dt), 0.005 * static_cast<double>(input.imu.size()),
                  1e-6);
    }
    EXPECT_NEAR(seconds, 0.25, 1e-6);
    return samples;
  };
  EXPECT_EQ(integrated({0, 1, 2, 3, 4, 5}), 50u);
  EXPECT_EQ(integrated({0, 3, 4, 5}), 50u);
  EXPECT_EQ(integrated({0, 2, 5}), 50u);
  request.camera = CameraRequest{10.0, Deadline::Drop};
  Feed slow(request);
  EXPECT_EQ(slow.size(), 3);
  EXPECT_EQ(slow.time_ns(1), AslFolder::frame_ns(2));
  EXPECT_EQ(slow.arrival_ns(2), 200'000'000);
  request.camera->fps = 30;
  expect_input_error([&] { Feed fast(request); }, {"recorded at 20 frames/s"});
}

/// Of the frames of the example, the second was lost and the third, of 60 ms, is late.
RunResult example_loop() {
  RunResult run = testing::example_run();
  run.camera = CameraRecord{20, Deadline::Drop, {}};
  for (int i = 0; i < 5; ++i)
    run.camera->deliveries.push_back(
        {i, 1'000'000'000 + 50'000'000 * i, 50'000'000 * i, i == 1 ? 1 : 0, i == 1});
  run.frames.erase(run.frames.begin() + 1);
  return run;
}

TEST(ClosedLoop, CountsLostAndLateFrames) {
  const CameraFigures figures = camera_figures(example_loop()).value();
  EXPECT_EQ(figures.arrived, 5);
  EXPECT_EQ(figures.processed, 4);
  EXPECT_EQ(figures.dropped, 1);
  EXPECT_EQ(figures.late, 1);
  EXPECT_EQ(figures.waited, 1);
  EXPECT_EQ(figures.missed(), 2);
  EXPECT_DOUBLE_EQ(figures.share_of(figures.missed()), 0.4);
  EXPECT_EQ(figures.latency.p50_ns, 30'000'000);
  EXPECT_EQ(figures.latency.p95_ns, 60'000'000);
  EXPECT_FALSE(camera_figures(testing::example_run()));
}

TEST(ClosedLoop, PercentilesAreValuesOfTheirRank) {
  std::vector<std::int64_t> values(20);
  std::iota(values.begin(), values.end(), 1);
  EXPECT_EQ(percentile(values, 0.5), 10);
  EXPECT_EQ(percentile(values, 0.95), 19);
  EXPECT_EQ(percentile(values, 0.951), 20);
  EXPECT_EQ(percentile(values, 1), 20);
  EXPECT_EQ(percentile(values, 0), 1);
  EXPECT_EQ(percentile({7}, 0.99), 7);
}

TEST(ClosedLoop, FilesSayOfEveryFrameWhatBecameOfIt) {
  const RunResult run = example_loop();
  const std::string csv = csv_text(frame_rows(run));
  for (const char* part :
       {"single_cycles,cycles_feature_extraction,cycles_epnp_ransac,found_in_"
        "buffers,dropped,missed\n",
        "\n1,1050000000,,,,,,,,,,,,,,,,,,50000000,,,,,,,,1,1,1\n",
        "\n0,1000000000,first,1,100,40,60,30,200,0,0,0,0,0,0,0,0,0,located,0,0,10000000,10000000,"
        "1000000,5000000,0,0,0,0,0\n",
        ",30000000,0,0,0,0,1\n"})
    EXPECT_NE(csv.find(part), std::string::npos) << part << " is not in:\n" << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
  const std::string statistics = testing::figures_text(run);
  for (const char* part : {"\"camera.dropped\"", "\"camera.missed\""}) {
    EXPECT_NE(statistics.find(part), std::string::npos) << part;
    EXPECT_EQ(testing::figures_text(testing::example_run()).find(part), std::string::npos) << part;
  }
  const std::string text = report(run);
  for (const char* part :
       {"closed loop: camera at 20 frames/s; a frame that finds the front end busy is dropped",
        "5 arrived, 4 processed, 1 (20.0 %) dropped; 1 (20.0 %) late, so 2 (40.0 %) missed",
        "p50 30.00, p95 60.00"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
}

RunResult on_gap9(const std::string& data, std::optional<CameraRequest> camera,
                  const std::string& clock) {
  RunRequest request;
  request.data = data;
  request.profile = "next";
  request.platform =
      platform::resolve_platform("gap9", {"cluster.clock=" + clock, "controller.clock=" + clock});
  request.camera = camera;
  return simulate(request, [](const Progress&) {});
}

std::vector<std::string> files_of(const RunResult& run) {
  return {testing::figures_text(run), csv_text(frame_rows(run)), csv_text(energy_rows(run)),
          traces::format_tum(run.trajectory)};
}

/// One flight for everything that needs one.
TEST(ClosedLoop, BendsTheTrajectoryOnlyWhereTheChipIsTooSlow) {
  const traces::testing::TempFolder folder;
  traces::write_synthetic_flight(folder / "flight", {.duration_s = 2, .texel_m = 0.01});
  const std::string flight = (folder / "flight").string();
  const CameraRequest drop{{}, Deadline::Drop};

  const RunResult open = on_gap9(flight, {}, "370MHz");
  const RunResult fast = on_gap9(flight, drop, "370MHz");
  ASSERT_EQ(open.optimiser_late, 0);
  EXPECT_EQ(camera_figures(fast)->missed(), 0);
  EXPECT_EQ(traces::format_tum(fast.trajectory), traces::format_tum(open.trajectory));
  // The same energy: no frame is lost, and the time is the same.
  EXPECT_NEAR(energy_of(fast)->total().total().value.count(),
              energy_of(open)->total().total().value.count(), 1e-9);

  const RunResult slow = on_gap9(flight, drop, "45MHz");
  const CameraFigures figures = camera_figures(slow).value();
  EXPECT_GT(figures.dropped, 5);
  EXPECT_EQ(slow.trajectory.size(), slow.frames.size());
  EXPECT_EQ(figures.processed + figures.dropped, static_cast<std::int64_t>(open.frames.size()));
  ASSERT_TRUE(slow.ate);
  EXPECT_NEAR(slow.ate->completion, figures.share_of(figures.processed), 1e-9);
  EXPECT_NE(slow.ate->translation.rmse, open.ate->translation.rmse);
  EXPECT_LT(energy_of(slow)->mean_power()->value.count(),
            energy_of(open)->mean_power()->value.count());
  // Two seconds and no less, however many frames were processed.
  EXPECT_GE(energy_of(slow)->time.count(), 1.999);
  EXPECT_EQ(files_of(on_gap9(flight, drop, "45MHz")), files_of(slow));
}

}  // namespace
}  // namespace leviosim::tools
