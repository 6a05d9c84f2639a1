// Plans of flight benchmarks: what they may say, where pieces begin.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/traces/test_folder.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/flight_pieces.h"
#include "tools/app/study/flights/flight_plan.h"
#include "traces/datasets/asl_reader.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

using traces::FrameRange;
using traces::testing::AslFolder;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

/// At rest but for one stretch, in which it moves along x.
traces::Trajectory moving_between(double begin_s, double end_s, double speed) {
  traces::Trajectory truth;
  for (int i = 0; i <= 100 * 100; ++i) {
    const double t = i / 100.0;
    traces::StampedPose& pose = truth.emplace_back();
    pose.t_ns = std::int64_t{i} * 10'000'000;
    pose.T_world_body.translation() << speed * (std::clamp(t, begin_s, end_s) - begin_s), 0, 1;
  }
  return truth;
}

std::vector<std::int64_t> stamps(int frames, std::int64_t first_ns) {
  std::vector<std::int64_t> all;
  for (int i = 0; i < frames; ++i) all.push_back(first_ns + std::int64_t{i} * 50'000'000);
  return all;
}

TEST(FlightStarts, AreEverySoManySecondsWhereTheVehicleMoves) {
  const traces::Trajectory truth = moving_between(19, 70.5, 0.5);
  const Starts starts = starts_in_motion(stamps(1990, 10'000'000), truth, 20);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{400, 800, 1200}));
  EXPECT_EQ(starts.at_rest, 1u) << "after 80 s";
}

TEST(FlightStarts, AskForATenthOfAMetreInASecond) {
  const auto starts_at = [](double speed) {
    return starts_in_motion(stamps(500, 0), moving_between(0, 100, speed), 20).frames.size();
  };
  EXPECT_EQ(starts_at(0.099), 0u);
  EXPECT_EQ(starts_at(0.101), 1u);
}

TEST(FlightStarts, TakeTheFirstFrameAfterTheTime) {
  std::vector<std::int64_t> late = stamps(100, 0);
  late.erase(late.begin() + 20, late.begin() + 23);  // no frame at 1.00, 1.05 and 1.10 s
  const Starts starts = starts_in_motion(late, moving_between(0, 100, 1), 1);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{20, 37, 57, 77}));
  EXPECT_EQ(late[20], 1'150'000'000);
}

TEST(FlightStarts, NeverTakeAFrameTwice) {
  const Starts starts = starts_in_motion(stamps(4, 0), moving_between(0, 100, 1), 0.01);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(FlightStarts, TakeAsLongAsThereAreFrames) {
  std::vector<std::int64_t> apart = stamps(4, 0);
  apart.back() = 9'000'000'000'000'000'000;
  const Starts starts = starts_in_motion(apart, moving_between(0, 100, 1), 0.01);
  EXPECT_EQ(starts.frames, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(starts.at_rest, 1u);
}

TEST(FlightStarts, PathsAreThoseOfTheTruth) {
  const traces::Trajectory truth = moving_between(10, 20, 0.5);
  EXPECT_NEAR(true_path_m(truth, 0, 100'000'000'000), 5, 1e-9);
  EXPECT_NEAR(true_path_m(truth, 12'000'000'000, 14'000'000'000), 1, 1e-9);
  EXPECT_EQ(true_path_m(truth, 30'000'000'000, 40'000'000'000), 0);
}

std::string text_of(const std::vector<FrameRange>& ranges) {
  std::string text;
  for (const FrameRange& range : ranges) text += fmt::format("{}:{} ", range.begin, range.end);
  return text;
}

TEST(FlightStarts, RangesThatTouchAreDrawnAsOne) {
  EXPECT_EQ(text_of(merged({{8, 9}, {0, 2}, {2, 4}, {3, 4}, {6, 8}})), "0:4 6:9 ");
  const std::vector<FrameRange> drawn{{2, 5}, {10, 14}};
  EXPECT_EQ(text_of({within(drawn, {3, 5})}), "1:3 ");
  EXPECT_EQ(text_of({within(drawn, {11, 14})}), "4:7 ");
}

constexpr const char* kPlan =
    "motions: [a, b]\nworlds: { development: [1], fresh: [2, 3] }\npieces: [3, whole]\n";

TEST(FlightPlans, AreReadWithTheirDefaults) {
  const FlightPlan plan = parse_flight_plan("p.yaml", kPlan);
  EXPECT_EQ(plan.motions, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(plan.sets.size(), 2u);
  EXPECT_EQ(plan.sets[1].name, "fresh");
  EXPECT_EQ(plan.sets[1].worlds, (std::vector<traces::Place>{{.seed = 2}, {.seed = 3}}));
  EXPECT_EQ(plan.lengths, (std::vector<std::size_t>{3, kWholeFlight}));
  EXPECT_EQ(plan.every_s, 20);
  EXPECT_EQ(plan.seeds, (std::vector<std::uint32_t>{1, 2, 3}));
  ASSERT_EQ(plan.variants.size(), 1u);
  EXPECT_EQ(plan.variants[0].name(), "next");
  const FlightPlan more = parse_flight_plan(
      "p.yaml", std::string(kPlan) +
                    "every: 2.5\nseeds: [7]\nsize: 32x24\nvariants:\n  - { profile: levio }\n"
                    "  - { profile: next, workload.window: 8, workload.guided: off }\n");
  EXPECT_EQ(more.every_s, 2.5);
  EXPECT_EQ(more.size.width, 32);
  ASSERT_EQ(more.variants.size(), 2u);
  EXPECT_EQ(more.variants[1].name(), "next window=8 guided=off");
}

TEST(FlightPlans, ThatHaveNamesAreWhole) {
  EXPECT_GE(builtin_flight_plans().size(), 5u);
  for (const base::BuiltinFile& file : builtin_flight_plans()) {
    const FlightPlan plan = flight_plan_named(std::string(file.name));
    EXPECT_EQ(plan.name, file.name);
    if (file.name == "distances") {  // nothing is chosen there; a set for each distance
      EXPECT_EQ(plan.sets.size(), 5u);
      continue;
    }
    ASSERT_EQ(plan.sets.size(), 2u) << file.name;
    EXPECT_EQ(plan.sets[0].name, "development");
    EXPECT_EQ(plan.sets[1].name, "fresh");
  }
  expect_input_error([] { flight_plan_named("mid-ari"); },
                     {"'mid-ari'", "did you mean 'mid-air'", "or a file"});
}

TEST(FlightPlans, RefuseFaultsWithTheirPlace) {
  const auto refuse = [](const std::string& from, const std::string& to,
                         std::initializer_list<std::string> parts) {
    std::string text = kPlan;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    expect_input_error([&] { parse_flight_plan("p.yaml", text); }, parts);
  };
  refuse("motions", "motion", {"p.yaml:1: motion", "did you mean 'motions'"});
  refuse("pieces: [3, whole]", "", {"p.yaml", "missing key 'pieces'"});
  refuse("[a, b]", "[]", {"p.yaml:1: motions", "is empty"});
  refuse("[a, b]", "[a, ../b]", {"p.yaml:1: motions", "'../b' is no plain name"});
  refuse("[a, b]", "[a, a]", {"p.yaml:1: motions", "'a' is given twice"});
  refuse("[a, b]", "a", {"p.yaml:1: motions", "is a single value; expected a list"});
  refuse("[2, 3]", "[1, 3]", {"p.yaml:2: worlds.fresh", "world 1 is in another set"});
  refuse("[2, 3]", "[-2]", {"p.yaml:2: worlds.fresh", "'-2'", "a whole number from 0"});
  refuse("3, whole", "2", {"p.yaml:3: pieces", "'2'", "from 3 to 1000000, rest, or whole"});
  refuse("3, whole", "all", {"p.yaml:3: pieces", "'all'", "or whole"});
  const auto refuse_more = [&](const std::string& line, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_flight_plan("p.yaml", kPlan + line); }, parts);
  };
  refuse_more("every: 0", {"p.yaml:4: every", "'0'", "above 0"});
  for (const char* every : {"0.001", "86401", "1e10", "1e300"})
    refuse_more(fmt::format("every: {}", every),
                {"p.yaml:4: every", every, "expected 0.01 to 86400 s"});
  for (const char* every : {"nan", "-1", "1e999"})
    refuse_more(fmt::format("every: {}", every), {"p.yaml:4: every", every});
  refuse_more("seeds: [x]", {"p.yaml:4: seeds", "'x'"});
  refuse_more("size: 32", {"p.yaml:4: size", "32"});
  refuse_more("variants: []", {"p.yaml:4: variants", "is empty"});
  refuse_more("variants: [{ profile: nxet }]", {"p.yaml:4: variants.profile", "nxet"});
  refuse_more("variants: [{ workload.windw: 8 }]",
              {"p.yaml:4: variants.workload.windw", "did you mean 'workload.window'"});
  refuse_more("variants: [{ workload.window: 99 }]", {"p.yaml:4", "'99'", "from 2 to 32"});
  refuse_more("variants: [{ profile: next }, {}]", {"p.yaml", "'next' is given twice"});
}

/// The motion of AslFolder: six frames, 20 m/s.
class FlightPieces : public ::testing::Test {
 protected:
  FlightPieces() { std::filesystem::create_directory_symlink(data_.root(), folder_ / "a"); }
  Benchmark benchmark(const std::string& pieces) const {
    return make_benchmark(
        parse_flight_plan("p.yaml",
                          "motions: [a]\nworlds: { one: [1], two: [2, 3] }\nsize: 32x24\n"
                          "every: 0.1\npieces: " +
                              pieces),
        folder_.path().string());
  }

  AslFolder data_;
  TempFolder folder_;
};

TEST_F(FlightPieces, BeginAtTheStartsAndEndWithinTheFlight) {
  const Benchmark some = benchmark("[3]");
  ASSERT_EQ(some.pieces.size(), 3u) << "frames 2 to 4 in each world; frame 4 is too late";
  EXPECT_EQ(some.too_late, 1u);
  for (const FlightPiece& piece : some.pieces) {
    EXPECT_EQ(text_of({piece.frames}), "2:5 ");
    EXPECT_NEAR(piece.start_s, 0.1, 1e-9);
    EXPECT_NEAR(piece.path_m, 2, 1e-6);
  }
  EXPECT_EQ(some.pieces[0].set, 0u);
  EXPECT_EQ(some.pieces[2].world.seed, 3u);
  ASSERT_EQ(drawn_flights(some).size(), 3u);
  EXPECT_EQ(text_of(drawn_flights(some)[0].frames), "2:5 ");
  EXPECT_EQ(benchmark("[4]").pieces.size(), 3u) << "up to the last frame";
  const Benchmark both = benchmark("[3, whole]");
  EXPECT_EQ(both.pieces.size(), 6u);
  EXPECT_EQ(text_of(drawn_flights(both)[0].frames), "0:6 ");
  expect_input_error([&] { benchmark("[5]"); }, {"p.yaml", "no piece", "0.1 s"});
}

TEST_F(FlightPieces, OfRecordingsBeginAtFramesAndNeedNoDrawing) {
  std::filesystem::create_directory_symlink(data_.root(), folder_ / "b");
  const Benchmark some = make_benchmark(
      parse_flight_plan("p.yaml",
                        "recordings: [b]\nstarts: { even: [0, 2], odd: [1, 2] }\nsize: 32x24\n"
                        "pieces: [3, rest]\nseeds: [1]\ndisturbances: [none, noise=9]\n"),
      folder_.path().string());
  std::string ranges;
  for (const FlightPiece& piece : some.pieces)
    if (piece.disturbance == 1) ranges += text_of({piece.frames});
  EXPECT_EQ(ranges, "0:3 2:5 1:4 3:6 0:6 2:6 1:6 ") << "rests are longer than three frames";
  EXPECT_EQ(some.pieces.size(), 14u);
  EXPECT_TRUE(drawn_flights(some).empty());
  const std::vector<Point> runs = benchmark_runs(some);
  ASSERT_EQ(runs.size(), 14u);
  std::set<std::string> keys;
  for (const Point& run : runs) keys.insert(run_key(run, {}, platform::Schema()));
  EXPECT_EQ(keys.size(), 14u);
  EXPECT_EQ(runs[1].request.disturbance.text(), "noise=9");
  EXPECT_EQ(text_of({*runs[3].request.frames}), "2:5 ");
}

/// Also of those that are no ASL folders.
TEST_F(FlightPieces, OfRecordingsOfOtherFormatsBeginAtTheirFrames) {
  const traces::Dataset asl = traces::read_asl(data_.root());
  const std::filesystem::path other = folder_ / "other";
  std::filesystem::create_directories(other / "cam0");
  std::filesystem::copy(data_.mav0("cam0/sensor.yaml"), other / "cam0/sensor.yaml");
  std::string frames;
  for (const traces::FrameRef& frame : asl.frames)
    frames += fmt::format("{}.{:09} {}\n", frame.t_ns / 1'000'000'000, frame.t_ns % 1'000'000'000,
                          frame.path.string());
  std::ofstream(other / "rgb.txt") << frames;
  std::ofstream(other / "groundtruth.txt")
      << traces::format_tum(traces::to_trajectory(asl.ground_truth));
  const Benchmark some = make_benchmark(
      parse_flight_plan("p.yaml",
                        "recordings: [other]\nstarts: { odd: [1, 2] }\nsize: 32x24\npieces: [3]\n"
                        "variants: [{ profile: levio-no-imu }]\n"),
      folder_.path().string());
  ASSERT_EQ(some.pieces.size(), 2u);
  EXPECT_EQ(text_of({some.pieces[0].frames, some.pieces[1].frames}), "1:4 3:6 ");
}

TEST(FlightPlans, OfRecordingsNeedStarts) {
  const auto refuse = [](const std::string& text, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_flight_plan("p.yaml", text + "\npieces: [3]"); }, parts);
  };
  refuse("recordings: [a]", {"missing key 'starts'"});
  refuse("recordings: [a]\nstarts: { x: [1] }", {"p.yaml:2: starts.x", "[FIRST, STEP]"});
  refuse("recordings: [a]\nstarts: { x: [1, 0] }", {"p.yaml:2: starts.x", "'0'"});
  refuse("recordings: [a]\nstarts: { x: [1, 2] }\ndisturbances: [nosie=1]",
         {"p.yaml:3: disturbances", "did you mean 'noise'"});
}

TEST_F(FlightPieces, NeedTheRecordedImu) {
  std::filesystem::remove(data_.mav0("imu0/data.csv"));
  expect_input_error([&] { benchmark("[3]"); }, {"a: there is no imu0/data.csv"});
}

}  // namespace
}  // namespace leviosim::tools
