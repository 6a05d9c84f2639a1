// `leviosim tune`: what it asks for, what it chooses, and the command as users meet it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/energy/supply.h"
#include "tests/support/run_program.h"
#include "tools/app/study/tune/tune_plan.h"
#include "tools/app/study/tune/tune_report.h"
#include "tools/app/study/tune/tuning.h"
#include "tools/app/table/table_files.h"
#include "traces/datasets/rng.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::contents;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

constexpr std::int64_t kMega = 1'000'000;

std::vector<std::int64_t> megahertz(const std::vector<Hertz>& clocks) {
  std::vector<std::int64_t> all;
  for (const Hertz clock : clocks) all.push_back(clock.count() / kMega);
  return all;
}

TEST(TuneOptions, ClocksAreRangesAndLists) {
  using Clocks = std::vector<std::int64_t>;
  EXPECT_EQ(megahertz(parse_clocks("100:130:10")), (Clocks{100, 110, 120, 130}));
  EXPECT_EQ(megahertz(parse_clocks("100:125:10")), (Clocks{100, 110, 120}));
  EXPECT_EQ(megahertz(parse_clocks("240")), (Clocks{240}));
  EXPECT_EQ(megahertz(parse_clocks("370,100:120:20")), (Clocks{100, 120, 370}));
  EXPECT_EQ(megahertz(parse_clocks("240MHz,370")), (Clocks{240, 370}));
  EXPECT_EQ(parse_clocks("12.5"), (std::vector<Hertz>{Hertz(12'500'000)}));
  for (const char* text : {"", "0", "-5", "fast", "100:200", "100:200:", "100:200:0", "1:2:3:4",
                           "100:200:-10", "nan", "1e300"})
    expect_input_error([&] { parse_clocks(text); }, {"--clock", "expected"});
  expect_input_error([] { parse_clocks("200:100:10"); }, {"200:100:10", "range is empty"});
  expect_input_error([] { parse_clocks("100,100"); }, {"every value once"});
  expect_input_error([] { parse_clocks("1:100:0.000001"); }, {"no more than 10000"});
}

TEST(TuneOptions, SeedsAreAList) {
  EXPECT_EQ(parse_seed_list("3,1"), (std::vector<std::uint32_t>{3, 1}));
  for (const char* text : {"", "-1", "1,", "one", "1,1"})
    expect_input_error([&] { parse_seed_list(text); }, {"--seed", "expected"});
}

TEST(TuneOptions, RatesAreAbove0) {
  EXPECT_EQ(parse_rates("20,10,7.5"), (std::vector<double>{7.5, 10, 20}));
  for (const char* text : {"", "0", "-1", "10,", "ten", "10,1e-10"})
    expect_input_error([&] { parse_rates(text); }, {"--fps", "above 0"});
  expect_input_error([] { parse_rates("10,10"); }, {"--fps '10,10'", "every value once"});
}

TEST(TuneOptions, AClockComesWithTheLowestVoltageThatAllowsIt) {
  const sim::ChipConfig gap9 = platform::resolve_platform("gap9").config;
  const auto at = [&](std::int64_t mhz) { return setting_for(gap9, "gap9", Hertz(mhz * kMega)); };
  EXPECT_DOUBLE_EQ(at(100).voltage->count(), 0.65);
  EXPECT_DOUBLE_EQ(at(240).voltage->count(), 0.65);
  EXPECT_DOUBLE_EQ(at(241).voltage->count(), 0.70);
  EXPECT_DOUBLE_EQ(at(370).voltage->count(), 0.80);
  for (const std::int64_t mhz : {100, 250, 330, 370}) {
    // A platform of this setting is one that leviosim takes.
    const sim::ChipConfig chip = platform::resolve_platform("gap9", at(mhz).overrides).config;
    EXPECT_EQ(chip.cluster.clock, Hertz(mhz * kMega));
    EXPECT_EQ(chip.controller.clock, Hertz(mhz * kMega));
    EXPECT_LE(chip.cluster.clock, sim::highest_clock(chip.supply, chip.supply.voltage));
  }
  expect_input_error([&] { at(371); }, {"371 MHz", "gap9", "370 MHz", "0.8 V"});

  sim::ChipConfig uneven = gap9;
  uneven.controller.clock = Hertz(185 * kMega);
  EXPECT_EQ(setting_for(uneven, "uneven", Hertz(100 * kMega)).overrides[1],
            "controller.clock=50MHz");
  sim::ChipConfig without_supply = gap9;
  without_supply.supply = {};
  EXPECT_FALSE(setting_for(without_supply, "x", Hertz(900 * kMega)).voltage);
}

/// Points by rate, then clock, of which some meet the limits.
struct Example {
  TunePlan plan;
  std::vector<TunePoint> points;

  Example() {
    plan.options.platform = "gap9";
    plan.options.data = "my flight";
    plan.request.platform.name = "gap9";
    plan.sequence.folder = "flights/my flight/";
    plan.fps = {10, 20};
    plan.variations = {{.name = "seed 1"}};
    plan.screening = 1;
    plan.miss_rate = 0.05;
    plan.ate_m = 0.2;
    for (const std::int64_t mhz : {100, 200, 300})
      plan.clocks.push_back({Hertz(mhz * kMega), Volts(0.65), {"supply.voltage=0.65V"}});
    add(0, 100, 0.5);
    add(5, 0, 0.19);
    add(0, 6, 0.1);
    add(100, 0, {});
    add(0, 0, 0.3);
    add(1, 2, 0.2);
  }
  void add(std::int64_t dropped, std::int64_t late, std::optional<double> ate) {
    RunOutcome outcome;
    outcome.ate_m = ate;
    outcome.path_m = 5;
    outcome.failure = ate ? "" : "the pose, once, is no number";
    outcome.completion = 0.01 * static_cast<double>(100 - dropped);
    LoopOutcome loop{};
    loop.camera.arrived = 100;
    loop.camera.processed = 100 - dropped;
    loop.camera.dropped = dropped;
    loop.camera.late = late;
    loop.camera.latency = {10'000'000, 20'000'000, 30'000'000, 40'000'000};
    loop.power_w = Banded{0.0125, 0.01, 0.015};
    loop.frame_j = Banded{0.0005, 0.0004, 0.0006};
    outcome.loop = loop;
    const std::size_t i = points.size();
    points.push_back({plan.fps[i / 3], plan.clocks[i % 3], {outcome}});
  }
};

TEST(Tuning, ChoosesTheLowestClockThatIsEnough) {
  const Example example;
  const std::vector<Choice> all = choices(example.plan, example.points);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].lowest, nullptr) << "the highest clock has 6 % late";
  EXPECT_EQ(all[0].highest_failing, &example.points[2]);
  ASSERT_EQ(all[0].lucky.size(), 1u);
  EXPECT_EQ(all[0].lucky[0], &example.points[1]);
  EXPECT_EQ(all[1].lowest, &example.points[5]);  // exactly at the limit
  EXPECT_EQ(chosen(all), &example.points[5]);

  Example equal;
  equal.points[2].outcomes[0].loop->camera.late = 5;
  EXPECT_EQ(chosen(choices(equal.plan, equal.points)), &equal.points[1]);
  equal.points[4].outcomes[0].ate_m = 0.1;
  EXPECT_EQ(chosen(choices(equal.plan, equal.points)), &equal.points[4]);
  equal.plan.ate_m = 0.05;
  EXPECT_EQ(chosen(choices(equal.plan, equal.points)), nullptr);
  EXPECT_NE(tune_conclusion(choices(equal.plan, equal.points)).find("no point meets the limits"),
            std::string::npos);
}

TEST(Tuning, FiguresAreMediansOverTheSeeds) {
  const Example example;
  TunePoint point = example.points[0];  // 100 % missed, 0.5 m
  point.outcomes.push_back(example.points[1].outcomes[0]);
  point.outcomes.push_back(example.points[2].outcomes[0]);
  EXPECT_DOUBLE_EQ(point.miss_rate(), 0.06);
  EXPECT_DOUBLE_EQ(point.drop_rate(), 0);
  EXPECT_DOUBLE_EQ(point.completion(), 0.95);
  EXPECT_EQ(point.ate().median, 0.19);
  EXPECT_EQ(point.ate().high, 0.5);
  EXPECT_DOUBLE_EQ(point.median(&LoopOutcome::power_w)->low, 0.01);
  point.outcomes[0].ate_m = 5.1;  // more than was flown
  EXPECT_EQ(point.ate().median, 0.19);
  EXPECT_FALSE(point.ate().high);
  point.outcomes[1].ate_m.reset();
  EXPECT_FALSE(point.ate().median);
  for (RunOutcome& outcome : point.outcomes) outcome.loop->power_w.reset();
  EXPECT_FALSE(point.median(&LoopOutcome::power_w));
}

/// A median would hide a start from which the map is wrong.
TEST(Tuning, NineteenOfTwentyRunsMustMeetTheError) {
  Example example;
  example.plan.ate_m = 0.2;
  TunePoint point = example.points[5];  // at the limits
  point.outcomes.assign(20, point.outcomes[0]);
  point.outcomes[3].ate_m = 0.21;
  EXPECT_EQ(point.failures(0.2), 1u);
  EXPECT_TRUE(is_enough(point, example.plan));
  point.outcomes[7].ate_m.reset();
  EXPECT_EQ(point.failures(0.2), 2u);
  EXPECT_FALSE(is_enough(point, example.plan));
}

TEST(Tuning, SaysWhatItFound) {
  Example example;
  EXPECT_NE(choice_text(example.plan, choices(example.plan, example.points))
                .find("10 frames/s: none of these clocks\n    lower ones that meet the limits by "
                      "chance: 200 MHz (5.0 %, 0.190); 300 MHz (6.0 %, 0.100) does not"),
            std::string::npos);
  example.points[2].outcomes[0].loop->camera.late = 5;
  const std::vector<Choice> all = choices(example.plan, example.points);
  const std::string text = choice_text(example.plan, all) + tune_conclusion(all) +
                           "\nnext: " + run_command_text(example.plan, *chosen(all)) + '\n';
  for (const char* part :
       {"at most 5 % missed", "10 frames/s: 200 MHz, 0.65 V: 5.0 % missed, ATE 0.190 m, 12.5 mW",
        "the lowest of all: 200 MHz",
        "leviosim run --platform gap9 -p supply.voltage=0.65V --data 'my flight' --fps 10 "
        "--deadline drop --out chosen\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  EXPECT_NE(tune_table(example.plan, example.points).find("diverged"), std::string::npos);
  const std::string csv = csv_text(tune_rows(example.plan, example.points));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  const Json rows = rows_json(read_csv("runs.csv", csv));  // refuses rows of another width
  EXPECT_EQ(rows.size(), 6u);
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [](const Json& row) {
    return row.at("failure") == "the pose, once, is no number";
  }));
}

TEST(Tuning, TheCommandOfSeveralSeedsIsALoopOverThem) {
  Example example;
  example.plan.variations = {{.name = "seed 2", .seed = 2}, {.name = "seed 7", .seed = 7}};
  const std::string text = run_command_text(example.plan, example.points[1]);
  EXPECT_EQ(text.rfind("for seed in 2 7; do leviosim run ", 0), 0u) << text;
  EXPECT_NE(text.find(" --seed $seed --out chosen-$seed; done"), std::string::npos) << text;
}

TEST(Tuning, AClockThatOtherStartsMissGivesWayToTheNextOne) {
  Example example;
  example.plan.fps = {10};
  example.points = {example.points[1], example.points[1], example.points[1]};
  example.plan.request.platform = platform::resolve_platform("gap9");
  for (std::size_t i = 0; i < 3; ++i)
    example.points[i].setting =
        setting_for(example.plan.request.platform.config, "gap9", example.plan.clocks[i].clock);
  example.plan.perturbs = true;
  example.plan.variations.resize(30);
  std::vector<std::size_t> asked;
  confirm(example.plan, example.points, [&](const std::vector<Point>& runs) {
    asked.push_back(runs.size());
    std::vector<RunOutcome> more(runs.size(), example.points[0].outcomes[0]);
    for (std::size_t i = 0; i < 2 && asked.size() == 1; ++i) more[i].ate_m = 0.3;  // 2 of 30
    return more;
  });
  EXPECT_EQ(asked, (std::vector<std::size_t>{29, 29}));
  const std::vector<Choice> all = choices(example.plan, example.points);
  EXPECT_EQ(all[0].lowest, &example.points[1]);
  EXPECT_EQ(all[0].highest_failing, &example.points[0]);
  EXPECT_EQ(example.points[2].outcomes.size(), 1u) << "what is not recommended needs no more runs";
  EXPECT_NE(claim_text(example.plan, example.points[1]).find("30 of 30"), std::string::npos);
}

TEST(ShareHeld, IsNoMoreThanTheRunsTell) {
  EXPECT_GE(share_held(59, 0), 0.95);
  EXPECT_LT(share_held(58, 0), 0.95);
  EXPECT_NEAR(share_held(13, 0), std::pow(0.05, 1.0 / 13), 1e-9);
  EXPECT_NEAR(share_held(1000, 0), 1 - 3.0 / 1000, 1e-5) << "the rule of three";
  EXPECT_EQ(share_held(3, 3), 0);
  traces::Rng rng(1);
  constexpr int kTrials = 4000;
  int covered = 0;
  for (int t = 0; t < kTrials; ++t) {
    std::size_t failures = 0;
    for (int i = 0; i < 40; ++i) failures += rng.uniform() < 0.1 ? 1 : 0;
    covered += share_held(40, failures) <= 0.9;
  }
  EXPECT_GE(covered, 0.94 * kTrials) << "of runs of which a tenth fails";
}

TEST(RunOutcome, KeepsAllOfAClosedLoop) {
  const Example example;
  const RunOutcome& outcome = example.points[1].outcomes[0];
  const RunOutcome read =
      run_outcome_of(record_of_json("", record_json(record_of(outcome)), Level::figures));
  ASSERT_TRUE(read.loop);
  EXPECT_EQ(record_json(record_of(read)), record_json(record_of(outcome)));
  EXPECT_EQ(read.loop->camera.latency.p99_ns, 30'000'000);
  EXPECT_EQ(read.loop->power_w->high, 0.015);
}

TEST(RunKey, OfALoopDependsOnChipAndCamera) {
  Point point{.request = {}, .work = "data inputs 1:2"};
  RunRequest& request = point.request;
  request.platform = platform::resolve_platform("gap9");
  std::vector<std::string> keys;
  const auto add = [&] { keys.push_back(run_key(point, {}, platform::Schema())); };
  add();
  request.camera = CameraRequest{{}, Deadline::Drop};
  add();
  request.camera->fps = 20;
  add();
  request.camera->deadline = Deadline::Queue;
  add();
  request.cores = 4;
  add();
  request.platform = platform::resolve_platform("gap9", {"cluster.fpu.units=2"});
  add();
  request.platform = platform::resolve_platform("gap9", {"cluster.clock=369MHz"});
  add();
  request.native = true;
  add();
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::unique(keys.begin(), keys.end()), keys.end());
}

/// A folder of 6 frames without features: fast, and good enough for messages and files.
class TuneCommand : public ::testing::Test {
 protected:
  std::vector<std::string> words(std::vector<std::string> further) const {
    std::vector<std::string> all{"tune",      "--data",  data_.root().string(),
                                 "--size",    "32x24",   "--out",
                                 path("out"), "--cache", path("runs")};
    all.insert(all.end(), further.begin(), further.end());
    return all;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void expect_refusal(const std::vector<std::string>& further,
                      const std::vector<std::string>& parts) {
    expect_refused(run_program(folder_.path(), words(further)), parts);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    EXPECT_FALSE(fs::exists(folder_ / "runs"));
  }

  AslFolder data_;
  TempFolder folder_;
};

TEST(DefaultClocks, ReachTheChipsHighest) {
  std::vector<double> megahertz_of_gap9;
  for (const Hertz clock : default_clocks(platform::resolve_platform("gap9").config))
    megahertz_of_gap9.push_back(static_cast<double>(clock.count()) / 1e6);
  EXPECT_EQ(megahertz_of_gap9, (std::vector<double>{50, 90, 140, 190, 230, 280, 320, 370}));
  for (const std::string& name : platform::platform_names()) {
    const sim::ChipConfig chip = platform::resolve_platform(name).config;
    const std::vector<Hertz> clocks = default_clocks(chip);
    EXPECT_TRUE(std::is_sorted(clocks.begin(), clocks.end())) << name;
    for (const Hertz clock : clocks) EXPECT_EQ(setting_for(chip, name, clock).clock, clock) << name;
  }
}

TEST_F(TuneCommand, RefusesWhatCannotBe) {
  expect_refusal({"--clock", "fast"}, {"--clock 'fast'", "100:370:10"});
  expect_refusal({"--clock", "100:400:10"}, {"400 MHz", "no voltage of GAP9", "370 MHz"});
  expect_refusal({"--clock", "100", "--fps", "10,30"}, {"30 frames/s", "recorded at 20 frames/s"});
  expect_refusal({"--clock", "100", "--deadline", "dorp"}, {"'dorp'", "did you mean 'drop'"});
  expect_refusal({"--clock", "100", "--miss-rate", "5"}, {"--miss-rate '5'", "0.05 for 5 %"});
  expect_refusal({"--clock", "100", "-p", "cluster.clock=100MHz"}, {"--clock", "leave it out"});
}

TEST_F(TuneCommand, FindsFinishedLoopsAgainAndConfirmsTheChosenOne) {
  const std::vector<std::string> typed =
      words({"--clock", "2:6:2", "--fps", "10,20", "--ate", "1000", "--miss-rate", "0.6", "-p",
             "workload.window=6", "--seed", "2,1"});
  const ProgramResult first = run_program(folder_.path(), typed);
  ASSERT_EQ(first.status, 0) << first.err;
  for (const char* part : {"12 closed loops", "the lowest of all: ", "confirmed", "results: "})
    EXPECT_NE(first.out.find(part), std::string::npos) << part << " is not in:\n" << first.out;
  const Json manifest = Json::parse(base::read_text_file(folder_ / "out/manifest.json"));
  const auto line = manifest.at("chosen").get<std::string>();
  EXPECT_NE(first.out.find("next: " + line + '\n'), std::string::npos) << first.out;
  auto files = contents(folder_ / "out");
  for (const char* name : {"runs.csv", "manifest.json", "chosen/frames.csv"})
    EXPECT_TRUE(files.count(name)) << name;

  // What is printed, pasted into a shell, runs the chosen point with each seed.
  fs::create_directory(folder_ / "bin");
  fs::create_symlink(leviosim::tests::program_path(), folder_ / "bin/leviosim");
  const std::string pasted = fmt::format("cd '{}' && PATH='{}':$PATH && {{ {}\n}} >pasted.txt 2>&1",
                                         path(""), path("bin"), line);
  EXPECT_EQ(std::system(pasted.c_str()), 0)  // NOLINT: the command is leviosim's own
      << base::read_text_file(folder_ / "pasted.txt");
  EXPECT_TRUE(fs::exists(folder_ / "chosen-1/run.json"));
  for (const char* name : {"frames.csv", "run.json", "trajectory.tum", "platform.yaml"})
    EXPECT_EQ(base::read_text_file(folder_ / "chosen-2" / name),
              files[std::string("chosen/") + name])
        << name;

  // One of the loops is lost: the others are found, and everything is as before.
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "runs"))
    if (entry.is_regular_file()) {
      fs::remove(entry.path());
      break;
    }
  std::vector<std::string> again = typed;
  again.insert(again.end(), {"--force", "--jobs", "1"});
  const ProgramResult second = run_program(folder_.path(), again);
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_EQ(second.out, first.out);
  EXPECT_NE(second.err.find("run 12/12, 11 of them done before"), std::string::npos) << second.err;
  auto files_again = contents(folder_ / "out");
  for (const char* name : {"manifest.json", "chosen/manifest.json"}) {  // command line, host time
    files.erase(name);
    files_again.erase(name);
  }
  EXPECT_EQ(files_again, files);
}

TEST_F(TuneCommand, HasThreeSeedsByDefaultAndHoldsTheChosenPointAgainstABudget) {
  outputs::write_file_atomically(folder_ / "budgets.yaml",
                                 "budgets:\n  - limits: [L1 peak <= 1 kB, completion >= 1 %]\n");
  const ProgramResult result =
      run_program(folder_.path(), words({"--clock", "6", "--ate", "1000", "--miss-rate", "1",
                                         "--budget", path("budgets.yaml")}));
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_EQ(result.err.find("leviosim: "), std::string::npos) << result.err;
  for (const char* part : {"3 closed loops", "for seed in 1 2 3; do", "L1 peak <= 1 kB", "NOT MET",
                           "medians over 3 seeds", "3 limits, 2 not met"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " is not in:\n" << result.out;
  EXPECT_TRUE(fs::exists(folder_ / "out/chosen/run.json"));
  const ProgramResult none =
      run_program(folder_.path(), words({"--force", "--clock", "6", "--ate", "0.000001",
                                         "--miss-rate", "0", "--budget", path("budgets.yaml")}));
  EXPECT_EQ(none.status, 1) << none.err;
  EXPECT_NE(none.out.find("no point to check against the budget"), std::string::npos) << none.out;
}

TEST_F(TuneCommand, RunsRefuseContradictoryLoops) {
  const auto refused = [&](std::vector<std::string> further,
                           const std::vector<std::string>& parts) {
    std::vector<std::string> all{"run",   "--data",   data_.root().string(), "--size", "32x24",
                                 "--out", path("out")};
    all.insert(all.end(), further.begin(), further.end());
    expect_refused(run_program(folder_.path(), all), parts);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  refused({"--native", "--deadline", "drop"}, {"--native", "leave out --deadline"});
  refused({"--platform", "gap9", "--fps", "30"},
          {"30 frames/s", "recorded at 20 frames/s", "at most 20"});
  refused({"--platform", "gap9", "--deadline", "drop", "--record"}, {"--record", "open loops"});
}

TEST(RunOptions, AskForALoopByRateOrDeadline) {
  EXPECT_FALSE(parse_camera("", ""));
  EXPECT_EQ(parse_camera("12.5", "")->fps, 12.5);
  EXPECT_EQ(parse_camera("12.5", "")->deadline, Deadline::Drop);
  EXPECT_FALSE(parse_camera("", "queue")->fps);
  EXPECT_EQ(parse_camera("", "queue")->deadline, Deadline::Queue);
  for (const char* fps : {"0", "-1", "fast", "nan", "1e-10", "1e6"})
    expect_input_error([&] { parse_camera(fps, ""); }, {"--fps", "above 0, from 0.001 to 100000"});
  expect_input_error([] { parse_camera("", "late"); }, {"--deadline 'late'", "drop or queue"});
}

}  // namespace
}  // namespace leviosim::tools
