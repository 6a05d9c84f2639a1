// The three verdicts of a run, each at its limits.
#include "tools/app/result/verdict.h"

#include <gtest/gtest.h>

#include "tests/tools/example_run.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/report/tables.h"

namespace leviosim::tools {
namespace {

/// Poses on a line of 10 m; the estimate's is `scale` times as long.
RunResult with_scale(double scale) {
  RunResult run = testing::example_run();
  run.ate->path_length_m = 10;
  run.ate->size_ratio = scale;
  return run;
}

RunResult with_error(double share, double path_m = 10) {
  RunResult run = testing::example_run();
  run.ate->path_length_m = path_m;
  run.ate->translation.rmse = share * path_m;
  return run;
}

/// Frames of 50 ms, of which `kept` in a row have no pose of their own.
RunResult with_kept(int kept) {
  RunResult run = testing::example_run();
  run.frames.clear();
  for (int i = 0; i < 100; ++i)
    run.frames.push_back(testing::frame(
        i, i >= 10 && i < 10 + kept ? PoseSource::Kept : PoseSource::Epnp, false, 1'000'000));
  run.trajectory.resize(run.frames.size());
  return run;
}

/// A hundred frames, so that states can change on the way.
RunResult long_run(double error_share) {
  RunResult run = with_kept(0);
  run.ate->path_length_m = 10;
  run.ate->translation.rmse = error_share * run.ate->path_length_m;
  return run;
}

using Texts = std::vector<std::string>;

Texts map_faults(const RunResult& run) { return map_verdict(figures_of(run).map).reasons; }
Grade map_grade(const RunResult& run) { return map_verdict(figures_of(run).map).grade; }
std::string text_of(const RunResult& run) { return figures_of(run).verdicts.text(); }
Grade grade_of(const RunResult& run) { return figures_of(run).verdicts.grade(); }

TEST(MapVerdict, AGoodMapHasNone) {
  EXPECT_EQ(map_faults(testing::example_run()), Texts());
  EXPECT_EQ(map_verdict(figures_of(RunResult()).map).word(), "not judged");
  EXPECT_EQ(map_warning(testing::example_run()), "");
}

TEST(MapVerdict, AnErrorAboveAShareOfThePath) {
  EXPECT_EQ(map_faults(with_error(0.099)), Texts());
  EXPECT_EQ(map_faults(with_error(0.213)), (Texts{"the error is 21.3 % of the path"}));
}

TEST(MapVerdict, AnErrorOnAShortPathCountsAsOnAMetre) {
  EXPECT_EQ(map_faults(with_error(0.99, 0.1)), Texts());
  EXPECT_EQ(map_faults(with_error(0.775 / 0.66, 0.66)),
            (Texts{"the error is 0.78 m on a path of 0.66 m"}));
  EXPECT_EQ(map_grade(with_error(0.24 / 0.5, 0.5)), Grade::doubtful);
  EXPECT_EQ(map_grade(with_error(0.26 / 0.5, 0.5)), Grade::bad);
  RunResult small = with_scale(3);
  small.ate->path_length_m = 0.9;
  small.ate->translation.rmse = 0.09;
  EXPECT_EQ(map_faults(small), Texts());
}

/// Dark or empty images are no fault of their own, but a reason of others.
TEST(MapVerdict, SaysThatImagesHaveNoFeatures) {
  RunResult run = with_error(0.05);
  for (FrameResult& frame : run.frames) frame.features = 3;
  EXPECT_EQ(map_faults(run), Texts());
  run.ate->translation.rmse = 3;
  EXPECT_EQ(map_faults(run),
            (Texts{"the error is 30.0 % of the path", "images have 3.0 features on average"}));
}

/// What comes before there is a map is no fault of the map.
TEST(MapVerdict, GuessesAreNamedAndNotJudged) {
  RunResult run = long_run(0.213);
  run.ate->located_rmse_m = 0.04;
  for (std::size_t i = 0; i < 3; ++i)
    run.frames[i].state = static_cast<int>(vio::PoseState::Initialising);
  const RunVerdict verdict = map_verdict(figures_of(run).map);
  EXPECT_EQ(verdict.grade, Grade::good);
  EXPECT_EQ(verdict.text(), fmt::format("map good: from frame {} on; 3 poses before are guesses",
                                        run.frames[3].index));
  run.ate->located_rmse_m = 1.15;
  EXPECT_EQ(map_grade(run), Grade::doubtful);
  run.frames[9].state = run.frames[0].state;
  EXPECT_EQ(map_faults(run).back(), "4 poses are guesses");
}

TEST(MapVerdict, SaysSinceWhenAReasonHolds) {
  RunResult run = long_run(0.05);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    run.frames[i].health = static_cast<int>(vio::Health::unreliable);
    run.frames[i].health_reasons =
        bit(vio::HealthReason::FewInliers) | (i < 7 ? 0 : bit(vio::HealthReason::Drift));
  }
  EXPECT_EQ(map_faults(run),
            (Texts{fmt::format("too few matches agree with the pose (since frame {})",
                               run.frames[0].index),
                   fmt::format("the length of the path is uncertain (since frame {})",
                               run.frames[7].index)}));
}

TEST(MapVerdict, KnowsSinceWhenTheVehicleRests) {
  RunResult run = long_run(0.05);
  EXPECT_FALSE(figures_of(run).map.at_rest_since);
  for (std::size_t i = 12; i < run.frames.size(); ++i) run.frames[i].at_rest = 1;
  EXPECT_EQ(figures_of(run).map.at_rest_since, run.frames[12].index);
  EXPECT_EQ(figures_of(run).value("map.at_rest_since"), run.frames[12].index);
  EXPECT_EQ(map_faults(run), (Texts{fmt::format("at rest since frame {}", run.frames[12].index)}));
  run.frames.back().at_rest = 0;
  EXPECT_FALSE(figures_of(run).map.at_rest_since);
}

/// Such as one that measures the exposure of each frame.
TEST(MapVerdict, IsNoneOfAWorkloadWithoutPoses) {
  RunResult run = testing::example_run();
  const auto has_map = [&] {
    const Verdicts verdicts = figures_of(run).verdicts;
    return std::any_of(verdicts.list.begin(), verdicts.list.end(),
                       [](const RunVerdict& v) { return v.about == "map"; });
  };
  EXPECT_TRUE(has_map());
  run.ate.reset();
  for (traces::StampedPose& pose : run.trajectory)
    pose.T_world_body = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(has_map());
  const std::string text = run_summary("title", run, 80, 0) + report(run);
  for (const char* word : {"trajectory:", "map good", "map not judged", "0.00 m\n"})
    EXPECT_EQ(text.find(word), std::string::npos) << word << "\n" << text;
}

TEST(MapVerdict, AScaleThatIsOffEitherWay) {
  for (const double right : {0.81, 1.0, 1.24}) EXPECT_EQ(map_faults(with_scale(right)), Texts());
  EXPECT_EQ(map_faults(with_scale(1.26)), (Texts{"the scale is 1.26"}));
  EXPECT_EQ(map_faults(with_scale(0.25)), (Texts{"the scale is 0.25"}));
}

/// As of an accelerometer with an axis the wrong way round.
TEST(MapVerdict, AVerticalThatIsOff) {
  MapSigns signs;
  signs.truth = {.error_m = 0.01, .path_m = 5, .scale = 1, .tilt_deg = 9.9};
  EXPECT_TRUE(map_verdict(signs).reasons.empty());
  signs.truth.tilt_deg = 14.5;
  EXPECT_EQ(map_verdict(signs).grade, Grade::doubtful);
  EXPECT_EQ(map_verdict(signs).reasons, (Texts{"the vertical is off by 14.5°"}));
}

TEST(MapVerdict, SaysOfWhichFramesItIs) {
  RunFigures run;
  run.map.has_poses = true;
  run.map.truth = {.error_m = 0.01, .path_m = 5, .scale = 1};
  for (const auto& [name, value] : {std::pair{"camera.arrived", 300.0}, {"camera.dropped", 148.0}})
    run.statistics.push_back({name, "1", "", value});
  EXPECT_EQ(verdicts_of(run).list.back().text(),
            "map good: of the 152 of 300 frames that were processed");
  run.map.truth = {};
  EXPECT_EQ(verdicts_of(run).list.back().text().find("processed"), std::string::npos)
      << "not judged";
}

TEST(MapVerdict, APoseThatIsKeptForSeconds) {
  EXPECT_EQ(map_faults(with_kept(40)), Texts());  // 2 s after the last pose
  EXPECT_EQ(map_faults(with_kept(41)).size(), 1u);
  EXPECT_EQ(map_faults(with_kept(48)), (Texts{"the pose was kept for 2.4 s"}));
  RunResult apart = with_kept(60);
  apart.frames[40].source = PoseSource::Tracked;
  EXPECT_EQ(map_faults(apart), Texts());
}

TEST(MapVerdict, AreAllNamedInOneWarningAtTheEnd) {
  RunResult run = with_kept(60);
  run.ate->translation.rmse = 2.7;  // of 5.4 m
  run.poses_left_out = 3;
  run.trajectory.resize(run.frames.size() - 3);
  EXPECT_EQ(map_warning(run),
            "warning: map lost: the error is 50.0 % of the path, the pose was kept for 3.0 "
            "s, 3 poses are NaN\n");
  const std::string text = report(run);
  EXPECT_TRUE(text.ends_with(map_warning(run)));
}

TEST(MapVerdict, FarBeyondTheLimitsItIsLost) {
  EXPECT_EQ(map_grade(with_error(0.099)), Grade::good);
  EXPECT_EQ(map_grade(with_error(0.24)), Grade::doubtful);
  EXPECT_EQ(map_grade(with_error(0.26)), Grade::bad);
  EXPECT_EQ(map_grade(with_scale(1.26)), Grade::doubtful);
  EXPECT_EQ(map_grade(with_scale(2.1)), Grade::bad);
  EXPECT_EQ(map_grade(with_scale(0.45)), Grade::bad);
}

TEST(MapVerdict, APoseThatIsKeptUpToTheEndIsLost) {
  EXPECT_EQ(map_grade(with_kept(60)), Grade::doubtful);
  EXPECT_EQ(map_grade(with_kept(90)), Grade::bad);
}

TEST(MapVerdict, BelievesAnEstimatorThatDoubtsItself) {
  MapSigns signs;
  signs.health = 0;
  EXPECT_EQ(map_verdict(signs).grade, Grade::good);
  signs.lost.frames = 3;
  EXPECT_EQ(map_verdict(signs).grade, Grade::doubtful);
  signs.health = 1;
  EXPECT_EQ(map_verdict(signs).grade, Grade::doubtful);
  signs.health = 2;
  EXPECT_EQ(map_verdict(signs).grade, Grade::bad);
}

TEST(MapVerdict, SaysWhyAnEstimatorDoubtsItself) {
  MapSigns signs;
  signs.health = 1;
  EXPECT_EQ(map_verdict(signs).reason(), "the estimator ends with a map that is unreliable");
  signs.health_reasons = bit(vio::HealthReason::FewInliers) | bit(vio::HealthReason::Drift);
  signs.reason_since[static_cast<std::size_t>(vio::HealthReason::Drift)] = 1335;
  EXPECT_EQ(map_verdict(signs).reason(),
            "too few matches agree with the pose (since frame 0), the length of the path is "
            "uncertain (since frame 1335)");
}

/// In metres, which say whether it matters; a share of next to nothing does not.
TEST(MapVerdict, SaysInMetresHowUncertainAPathIs) {
  RunResult run = long_run(0.001);
  run.frames.back().path_mm = 34;
  run.frames.back().path_deviation_mm = 3;
  EXPECT_EQ(map_faults(run), Texts());
  EXPECT_EQ(figures_of(run).value("map.path"), 0.034);
  EXPECT_EQ(figures_of(run).value("map.path_deviation"), 0.003);
  const std::string summary = run_summary("a run", run, 80);
  EXPECT_NE(summary.find("path uncertain by 0.00 m"), std::string::npos) << summary;
  run.frames.back().path_deviation_mm = 12;
  EXPECT_EQ(map_grade(run), Grade::good);
  EXPECT_EQ(map_faults(run), (Texts{"0.03 m of path, uncertain by 0.01 m"}));
  run.frames.back().health = static_cast<int>(vio::Health::unreliable);
  run.frames.back().health_reasons = bit(vio::HealthReason::Drift);
  EXPECT_EQ(map_grade(run), Grade::doubtful);
  EXPECT_EQ(map_faults(run),
            (Texts{fmt::format("0.03 m of path, uncertain by 0.01 m (since frame {})",
                               run.frames.back().index)}));
}

/// Of a map that has proved itself again.
TEST(MapVerdict, SaysInWhichFramesAnEstimatorDoubtedItselfBefore) {
  RunResult run = long_run(0.001);
  const auto doubt = [&](std::size_t i, vio::HealthReason reason) {
    run.frames[i].health = static_cast<int>(vio::Health::unreliable);
    run.frames[i].health_reasons |= bit(reason);
  };
  const auto frame = [&](std::size_t i) { return run.frames[i].index; };
  for (std::size_t i = 20; i < 44; ++i) doubt(i, vio::HealthReason::Blind);
  EXPECT_EQ(map_grade(run), Grade::good);
  EXPECT_EQ(map_faults(run),
            (Texts{fmt::format("no landmark has been seen for a while (frames {} to {})", frame(20),
                               frame(43))}));
  doubt(60, vio::HealthReason::Blind);
  doubt(3, vio::HealthReason::NoScale);  // of a guess
  EXPECT_EQ(map_faults(run),
            (Texts{fmt::format("no landmark has been seen for a while (25 of frames {} to {})",
                               frame(20), frame(60))}));
}

TEST(MapVerdict, WithoutTruthAndWithoutHealthNothingIsJudged) {
  MapSigns signs;
  EXPECT_EQ(map_verdict(signs).word(), "not judged");
  signs.health = static_cast<int>(vio::Health::not_judged);
  EXPECT_EQ(map_verdict(signs).word(), "not judged");
  signs.truth = {0.05, 10, 1.01, {}};
  EXPECT_EQ(map_verdict(signs).word(), "good");
  signs.truth.scale = 3;
  EXPECT_EQ(map_verdict(signs).word(), "lost");
  signs.truth = {0.05, 0.9, 3, {}};
  EXPECT_EQ(map_verdict(signs).word(), "not judged");
  EXPECT_EQ(map_verdict(signs).reason(),
            "there is no truth of 1 m or more, and the profile does not watch its map");
  signs.truth = {};
  signs.restarts = 9;
  EXPECT_EQ(map_verdict(signs).word(), "unreliable");
}

/// Numbers of baselines stay what they mean, whatever grades there are.
TEST(Grades, AreOrderedAndKeepTheirFigures) {
  EXPECT_EQ(severity(Grade::good), 0);
  EXPECT_EQ(severity(Grade::doubtful), 1);
  EXPECT_EQ(severity(Grade::bad), 2);
  EXPECT_GT(severity(Grade::unknown), severity(Grade::good));
  EXPECT_LT(severity(Grade::unknown), severity(Grade::doubtful));
}

/// One frame in four takes `slow_ms`, the others 20 ms; the period is 50 ms. Each waits for those
/// before it.
RunResult with_slow_frames(std::int64_t slow_ms) {
  RunResult run = testing::example_run();
  run.frames.clear();
  std::int64_t end = 0;
  for (int i = 0; i < 40; ++i) {
    FrameResult f = testing::frame(i, PoseSource::Epnp, false, 0);
    f.start_ns = std::max(f.arrival_ns, end);
    f.end_ns = end = f.start_ns + (i % 4 == 2 ? slow_ms : 20) * 1'000'000;
    run.frames.push_back(f);
  }
  run.trajectory.clear();
  for (const FrameResult& f : run.frames) run.trajectory.push_back(f.pose);
  return run;
}

TEST(TimeVerdict, FitsIfEveryFrameIsInTime) {
  EXPECT_EQ(text_of(with_slow_frames(50)),
            "fits: all 40 frames within 50 ms, worst 50 ms, memory fits, map good");
}

TEST(TimeVerdict, FewLateFramesFitOnAverage) {
  EXPECT_EQ(text_of(with_slow_frames(60)),
            "fits on average: 10 of 40 frames late, a frame takes 30 ms on average of 50 ms, worst "
            "60 ms, memory fits, map good");
}

/// The mean is that of the frames themselves: it does not grow with the flight, as the queue does.
TEST(TimeVerdict, ASlowChipIsToldByTheTimeOfAFrame) {
  RunResult run = with_slow_frames(180);
  EXPECT_EQ(text_of(run),
            "too slow: a frame takes 60 ms on average of 50 ms, which sustains 16.7 frames/s, "
            "memory fits, map good");
  EXPECT_EQ(figures_of(run).value("frame.time.mean"), 60e6);
  EXPECT_GT(figures_of(run).value("frame.latency.worst"), 180e6);
}

/// What the ranges of the platform leave open is said where the period lies in it.
TEST(TimeVerdict, SaysWhatItsBandLeavesOpen) {
  RunResult run = with_slow_frames(54);
  run.time_bands = TimeBands{{1, 0.9, 1.15}, {1, 0.88, 1.15}};
  EXPECT_EQ(text_of(run),
            "fits on average: 10 of 40 frames late, a frame takes 28.5 (26–33) ms on average of 50 "
            "ms, worst 54 (48–62) ms: the band includes 50, memory fits, map good");
  run = with_slow_frames(49);
  run.time_bands = TimeBands{{1, 0.9, 1.15}, {1, 0.88, 1.15}};
  EXPECT_EQ(text_of(run),
            "fits: all 40 frames within 50 ms, worst 49 (43–56) ms: the band includes 50, memory "
            "fits, map good");
  run.time_bands->slowest.high = 1.01;
  EXPECT_EQ(text_of(run).find("the band includes"), std::string::npos);
  run = with_slow_frames(180);
  run.time_bands = TimeBands{{1, 0.8, 1.15}, {1, 0.8, 1.15}};
  EXPECT_EQ(text_of(run),
            "too slow: a frame takes 60 (48–69) ms on average of 50 ms: the band includes 50, "
            "which sustains 16.7 frames/s, memory fits, map good");
}

/// Where no camera runs, the queue behind a slow frame only tells how the flight was recorded.
TEST(TimeVerdict, OfFramesByThemselvesUnlessACameraRuns) {
  RunResult run = with_slow_frames(90);  // the frame after each waits 40 ms and takes 20
  EXPECT_EQ(figures_of(run).value("frame.missed_share"), 0.25);
  run.camera = CameraRecord{20, Deadline::Queue, {}};
  for (const FrameResult& f : run.frames)
    run.camera->deliveries.push_back({f.index, f.t_ns, f.arrival_ns, 0, false});
  EXPECT_EQ(figures_of(run).value("frame.missed_share"), 0.5);
  EXPECT_NE(text_of(run).find("20 of 40 frames late"), std::string::npos) << text_of(run);
}

TEST(Verdicts, AreGreenOnlyIfAllAre) {
  RunResult run = with_slow_frames(20);
  EXPECT_EQ(grade_of(run), Grade::good);
  run.ate->translation.rmse = 2.04;  // of 5.4 m
  EXPECT_EQ(text_of(run),
            "map lost: the error is 37.8 % of the path, time fits: all 40 frames within 50 ms, "
            "worst 20 ms, memory fits");
  run.l1_size = Bytes(60'000);  // the example needs 64 000
  EXPECT_EQ(figures_of(run).verdicts.list[1].word(), "does not fit");
  EXPECT_EQ(figures_of(RunResult()).verdicts.text(), "no frames");
}

/// What the program promises of every verdict, over many runs.
TEST(Verdicts, AreNeverGreenOverAWrongMapOrALateFrame) {
  for (const double share : {0.02, 0.09, 0.11, 0.4})
    for (const std::int64_t slow_ms : {20, 50, 51, 101, 300}) {
      RunResult run = with_slow_frames(slow_ms);
      run.ate->translation.rmse = share * run.ate->path_length_m;
      EXPECT_EQ(grade_of(run) == Grade::good, share < 0.1 && slow_ms <= 50)
          << share << ' ' << slow_ms;
    }
}

}  // namespace
}  // namespace leviosim::tools
