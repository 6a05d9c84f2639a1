// Plans of sweeps: what they expand to, what they refuse, and which points are on the front.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/traces/test_folder.h"
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/synthetic.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

/// One second of synthetic flight, for points that are checked, not run.
const std::filesystem::path& flight() {
  static const std::filesystem::path folder = [] {
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("leviosim-{}-sweep-flight", ::getpid());
    traces::write_synthetic_flight(path, {.duration_s = 1, .texel_m = 0.05});
    return path;
  }();
  return folder;
}

class SweepPlans : public ::testing::Test {
 protected:
  static void TearDownTestSuite() { std::filesystem::remove_all(flight()); }

  /// @param points  begins on line 2
  Expansion expanded(const std::string& points, const std::string& more = {}) {
    const std::string text =
        fmt::format("base: {{ data: {}, platform: gap9{} }}\n{}", flight().string(), more, points);
    plan_ = parse_plan("plan.yaml", text, inputs_);
    return expand(plan_, inputs_);
  }
  std::vector<std::string> settings(const std::string& points, const std::string& more = {}) {
    std::vector<std::string> texts;
    const Expansion all = expanded(points, more);
    for (std::size_t i = 0; i < all.points.size(); ++i)
      texts.push_back(all.points[i].settings_text());
    return texts;
  }
  void expect_refused(const std::string& points, std::initializer_list<std::string> parts) {
    expect_input_error([&] { expanded(points); }, parts);
  }

  SweepInputs inputs_{".", ProgressLine::Style::None};
  SweepPlan plan_;
};

using Texts = std::vector<std::string>;

TEST_F(SweepPlans, AGridIsAllCombinationsTheLastKeyFastest) {
  EXPECT_EQ(settings("points: { grid: { workload.window: [4, 6], seed: [1, 2] } }"),
            (Texts{"workload.window=4 seed=1", "workload.window=4 seed=2",
                   "workload.window=6 seed=1", "workload.window=6 seed=2"}));
  EXPECT_EQ(settings("points: { grid: { platform.cluster.clock: { from: 100, to: 370, step: 90 } } "
                     "}"),
            (Texts{"platform.cluster.clock=100MHz", "platform.cluster.clock=190MHz",
                   "platform.cluster.clock=280MHz", "platform.cluster.clock=370MHz"}));
}

TEST_F(SweepPlans, MembersAreMultipliedAndGroupsFollowEachOther) {
  const Expansion all = expanded(
      "points:\n"
      "  - list:\n"
      "      - { profile: levio, seed: 3 }\n"
      "      - { profile: levio-no-imu }\n"
      "    grid: { cores: [1, 2, 8] }\n"
      "  - random: { number: 5, over: { platform.cluster.clock: { from: 100, to: 370 } } }\n");
  EXPECT_EQ(all.asked, 2u * 3 + 5);
  EXPECT_EQ(all.points.size(), 11u);
  EXPECT_EQ(all.points[1].settings_text(),
            "profile=levio seed=3 cores=2 platform.cluster.clock=370MHz");
  EXPECT_EQ(all.points[10].number, 11);
}

TEST_F(SweepPlans, TheSamePointIsThereOnceHoweverItIsWritten) {
  const Expansion all = expanded(
      "points:\n"
      "  - grid: { platform.cluster.clock: [0.37GHz, 370, 370 MHz, 240] }\n"
      "  - list: [{ workload.window: 10 }, { cores: 8 }, { profile: levio }, { seed: 1 }]\n"
      "  - grid: { platform.cluster.workers: [8, 4] }\n"
      "  - grid: { cores: [4] }\n");
  // 370 MHz, 240 MHz, perhaps the window, 4 workers; 4 of 8 workers is another chip.
  std::set<std::string> keys;
  for (std::size_t i = 0; i < all.points.size(); ++i)
    EXPECT_TRUE(keys.insert(all.points[i].key).second);
  const bool window_differs =
      vio::find_parameter("workload.window")->get(vio::profile_named("levio", 1)) != 10;
  EXPECT_EQ(all.points.size(), window_differs ? 5u : 4u);
  EXPECT_EQ(all.asked, 11u);
}

TEST_F(SweepPlans, UnknownKeysAreRefusedWithTheirPlace) {
  expect_refused("points:\n  - grid:\n      platform.cluster.clok: [240]\n",
                 {"plan.yaml:4", "platform.cluster.clok", "did you mean 'platform.cluster.clock'"});
  expect_refused("points: { grid: { workload.windw: [4] } }",
                 {"plan.yaml:2", "did you mean 'workload.window'"});
  expect_refused("points: { gird: { seed: [4] } }", {"plan.yaml:2", "did you mean 'grid'"});
  expect_refused("points: { random: { nmber: 3, over: { seed: [1] } } }",
                 {"plan.yaml:2", "did you mean 'number'"});
  expect_refused("points: { grid: { seed: { from: 1, until: 3 } } }", {"plan.yaml:2", "until"});
  expect_input_error([&] { expanded("points: { grid: { seed: [1] } }", ", platfrom.x: 1"); },
                     {"plan.yaml:1", "base.platfrom.x", "unknown key"});
}

TEST_F(SweepPlans, ValuesThatCannotBeAreRefusedWithTheirPlace) {
  expect_refused("points:\n  grid:\n    platform.cluster.workers: [4, 4.5]\n",
                 {"plan.yaml:4", "platform.cluster.workers", "4.5"});
  expect_refused("points: { grid: { platform.cluster.clock: [-1] } }", {"plan.yaml:2", "range"});
  expect_refused("points: { grid: { platform.cluster.fpu.mapping: [dynamc] } }",
                 {"plan.yaml:2", "did you mean 'dynamic'"});
  expect_refused("points: { grid: { workload.window: [1000] } }", {"plan.yaml:2", "1000"});
  expect_refused("points: { grid: { profile: [levo] } }", {"plan.yaml:2", "levio"});
  expect_refused("points: { grid: { seed: [-1] } }", {"plan.yaml:2", "-1"});
  expect_refused("points: { grid: { data: [nowhere] } }", {"plan.yaml:2", "nowhere"});
  expect_refused("points: { grid: { platform: [gap99] } }", {"plan.yaml:", "did you mean 'gap9'"});
  expect_refused("points: { grid: { seed: { from: 1, to: 3 } } }", {"plan.yaml:2", "step"});
  expect_refused("points: { grid: { seed: [1] }, list: [{ seed: 2 }] }", {"already set"});
  // Fine each by itself, but not together.
  expect_refused("points: { grid: { platform.supply.voltage: [0.65] } }",
                 {"plan.yaml:2", "0.65", "clock"});
  expect_refused("points: { grid: { cores: [9] } }", {"plan.yaml:2", "cores"});
}

TEST_F(SweepPlans, ImpossiblePointsAreLeftOutIfThePlanSaysSo) {
  const Expansion all = expanded(
      "points: { grid: { platform.supply.voltage: [0.65, 0.8], platform.cluster.clock: [240, 370], "
      "platform.controller.clock: [240] } }\n"
      "impossible: skip");
  EXPECT_EQ(all.points.size(), 3u);
  ASSERT_EQ(all.impossible, 1u);
  EXPECT_NE(all.first_impossible.find("370"), std::string::npos);
}

TEST_F(SweepPlans, DrawsAreWithinTheirRangesAndCanBeTypedAgain) {
  const Expansion all = expanded(
      "points: { random: { number: 200, seed: 5, over: {\n"
      "  platform.cluster.clock: { from: 100, to: 370, scale: log },\n"
      "  platform.cluster.icache.shared_size: { from: 1KiB, to: 16KiB, step: 1KiB },\n"
      "  workload.window: { from: 4, to: 6 },\n"
      "  platform.cluster.fpu.mapping: [fixed, dynamic] } } }");
  EXPECT_GT(all.points.size(), 190u);
  std::set<double> windows;
  std::set<std::string> mappings;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const SweepPoint p = all.points[i];
    EXPECT_GE(*p.parameters[0].number, 100);
    EXPECT_LE(*p.parameters[0].number, 370);
    EXPECT_LE(p.parameters[0].text.size(), 8u) << p.parameters[0].text;
    EXPECT_EQ(*p.parameters[1].number, std::round(*p.parameters[1].number));
    windows.insert(*p.parameters[2].number);
    mappings.insert(p.parameters[3].text);
  }
  EXPECT_EQ(windows, (std::set<double>{4, 5, 6}));
  EXPECT_EQ(mappings.size(), 2u);
}

/// Values of a key of some kind, good and bad ones, and such as contradict others.
const std::map<std::string, std::vector<std::string>>& some_values() {
  static const std::map<std::string, std::vector<std::string>> values{
      {"platform", {"gap9", "gap8", "gap9"}},
      {"platform.cluster.clock", {"240", "0.24GHz", "370MHz", "100", "371"}},
      {"platform.controller.clock", {"240", "100"}},
      {"platform.supply.voltage", {"0.65", "0.8V", "650mV"}},
      {"platform.cluster.workers", {"8", "4", "1"}},
      {"platform.cluster.max_workers", {"8", "9", "4"}},
      {"platform.cluster.fpu.mapping", {"fixed", "dynamic"}},
      {"platform.cluster.fpu.units", {"0", "4", "1"}},
      {"platform.isa.ops.f32_add.stall", {"0", "1"}},
      {"platform.cluster.core.ops.f32_add.stall", {"2"}},
      {"platform.energy.core.instruction", {"1"}},
      {"profile", {"levio", "levio-no-imu", "next"}},
      {"workload.window", {"10", "4"}},
      {"workload.joint", {"on", "off"}},
      {"workload.subpixel_steps", {"1", "4"}},
      {"seed", {"1", "2"}},
      {"size", {"160x120", "80x60", "64x47"}},
      {"cores", {"1", "4", "8", "9"}}};
  return values;
}

TEST_F(SweepPlans, PointsAreWhatResolvingEachOfThemGives) {
  // Random lists and grids with "skip": the same points, in the same order, of the same keys, as
  // are found by resolving every row by itself.
  traces::Rng rng(17);
  int points = 0;
  int left_out = 0;
  for (int trial = 0; trial < 25; ++trial) {
    std::vector<SweepRow> rows;
    std::string list;
    std::vector<std::string> names;
    for (const auto& [name, values] : some_values())
      if (rng.chance(0.35)) names.push_back(name);
    if (names.empty()) continue;
    for (int row = 0; row < 20; ++row) {
      SweepRow set;
      for (const std::string& name : names)
        if (const auto& values = some_values().at(name); rng.chance(0.7))
          set[name] = values[static_cast<std::size_t>(rng.below(static_cast<int>(values.size())))];
      if (set.empty()) set["seed"] = "1";
      std::string text;
      for (const auto& [name, value] : set)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name, value);
      list += fmt::format("  - {{ {} }}\n", text);
      rows.push_back(set);
    }
    Expansion all;
    try {
      all = expanded("impossible: skip\npoints:\n list:\n" + list);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("plan.yaml"), std::string::npos);
      continue;  // a value that this chip cannot have, or no point at all
    }
    std::set<std::string> seen;
    std::size_t impossible = 0;
    std::size_t i = 0;
    for (const SweepRow& row : plan_.groups.front().members.front().rows) {
      SweepRow settings = row;
      settings.insert(plan_.base.begin(), plan_.base.end());
      std::string identity;
      try {
        identity = resolve(plan_, settings, inputs_, "a point").identity;
      } catch (const InputError&) {
        ++impossible;
        continue;
      }
      if (!seen.insert(identity).second) continue;
      ASSERT_LT(i, all.points.size());
      const SweepPoint point = all.points[i++];
      EXPECT_EQ(point.key, point_key(kSweepFigures, identity));
      EXPECT_EQ(point.settings, settings);
      EXPECT_EQ(point.number, static_cast<int>(i));
    }
    EXPECT_EQ(i, all.points.size());
    EXPECT_EQ(all.impossible, impossible);
    points += static_cast<int>(i);
    left_out += static_cast<int>(impossible);
  }
  EXPECT_GT(points, 50);
  EXPECT_GT(left_out, 20);
}

TEST_F(SweepPlans, ParametersAreShownAsTheyAreWhereNothingSetsThem) {
  const Expansion all = expanded(
      "points:\n"
      "  - list:\n"
      "      - { platform.cluster.clock: 100, platform.cluster.fpu.mapping: dynamic }\n"
      "      - { workload.window: 4, profile: levio-no-imu, size: 80x60 }\n"
      "      - { platform.cluster.workers: 4 }\n"
      "      - { cores: 2, seed: 7 }\n");
  ASSERT_EQ(all.points.size(), 4u);
  const auto window = vio::find_parameter("workload.window")->get(vio::profile_named("levio", 1));
  EXPECT_EQ(all.points[0].settings_text(),
            fmt::format("platform.cluster.clock=100MHz platform.cluster.fpu.mapping=dynamic "
                        "workload.window={} profile=levio size=160x120 platform.cluster.workers="
                        "8 cores=8 seed=1",
                        window));
  EXPECT_EQ(all.points[1].settings_text(),
            "platform.cluster.clock=370MHz platform.cluster.fpu.mapping=fixed workload.window=4 "
            "profile=levio-no-imu size=80x60 platform.cluster.workers=8 cores=8 seed=1");
  EXPECT_EQ(all.points[2].parameters[6].text, "4");  // as many as workers
  EXPECT_EQ(all.points[2].parameters[6].number, 4);
  EXPECT_EQ(all.points[3].parameters[7].number, 7);
}

TEST(SweepSampling, ALatinHypercubeHasOnePointInEachStratumOfEachDimension) {
  for (const std::size_t count : {1u, 2u, 17u, 1000u}) {
    for (std::size_t d = 0; d < 3; ++d) {
      const std::vector<double> draws = latin_draws(count, d, 7);
      ASSERT_EQ(draws.size(), count);
      std::set<std::size_t> strata;
      for (const double draw : draws) {
        ASSERT_TRUE(draw >= 0 && draw < 1);
        strata.insert(static_cast<std::size_t>(draw * static_cast<double>(count)));
      }
      EXPECT_EQ(strata.size(), count) << d;
    }
  }
  EXPECT_EQ(latin_draws(50, 1, 1), latin_draws(50, 1, 1));
  EXPECT_NE(latin_draws(50, 1, 1), latin_draws(50, 1, 2));
  EXPECT_NE(latin_draws(50, 1, 1), latin_draws(50, 0, 1));
}

TEST_F(SweepPlans, MorePointsThanCanBeKeptAreRefusedBeforeAnyIsMade) {
  const std::string many = "{ from: 0, to: 999, step: 1 }";
  expect_refused(
      "points: { grid: { seed: " + many +
          ", cores: [1, 2, 3, 4, 5, 6, 7, 8], "
          "workload.window: [4, 5, 6, 7, 8, 9, 10, 11, 12, 13] , profile: [levio, next] } }",
      {"plan.yaml:2", "more than 100000 points"});
}

TEST(SweepSampling, MoreRandomPointsContinueFewer) {
  const auto few = random_draws(10, 2, 1);
  const auto more = random_draws(20, 2, 1);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), more.begin()));
  EXPECT_NE(random_draws(10, 1, 1), few);
}

TEST(SweepFront, IsWhatComparingAllPairsGives) {
  traces::Rng rng(3);
  std::vector<SweepOutcome> outcomes;
  for (int i = 1; i <= 400; ++i) {
    SweepOutcome outcome{i, rng.chance(0.05) ? "too small" : "", {}};
    for (auto& objective : outcome.objectives)  // few values, so that many are equal
      if (rng.chance(0.9)) objective = rng.below(12);
    outcomes.push_back(outcome);
  }
  std::set<int> expected;
  for (const SweepOutcome& a : outcomes) {
    bool beaten = !a.failure.empty();
    for (const SweepOutcome& b : outcomes) {
      bool no_worse = b.failure.empty();
      bool better = false;
      for (std::size_t k = 0; k < a.objectives.size(); ++k) {
        const double x = a.objectives[k].value_or(INFINITY);
        const double y = b.objectives[k].value_or(INFINITY);
        no_worse = no_worse && y <= x;
        better = better || y < x;
      }
      beaten = beaten || (no_worse && better);
    }
    if (!beaten) expected.insert(a.point);
  }
  std::set<int> front;
  for (const SweepOutcome& o : pareto_front(outcomes)) front.insert(o.point);
  EXPECT_EQ(front, expected);
  EXPECT_GT(front.size(), 3u);
}

TEST(RunRecord, ComesBackWithEveryBit) {
  RunRecord result;
  result.statistics = {{.name = "a", .unit = "ms", .value = 0.1 + 0.2},
                       {.name = "b", .unit = "1", .value = 3}};
  const std::string text = json_text(record_json(result));
  const RunRecord again = record_of_json("r", Json::parse(text), Level::figures);
  EXPECT_EQ(json_text(record_json(again)), text);
  EXPECT_EQ(again.value("a"), 0.1 + 0.2);
  for (const char* broken : {"{}", "{\"statistics\":3}", "{\"statistics\":{\"a\":[]}}",
                             "{\"statistics\":{\"a\":[\"1\",\"ms\"]}}"})
    expect_input_error([&] { record_of_json("r", Json::parse(broken), Level::figures); }, {"r: "});
}

}  // namespace
}  // namespace leviosim::tools
