// The store of a sweep alone: which plan it takes for its own, what a merge accepts, and what the
// front of an earlier publication leaves behind.
#include "tools/app/study/sweep/sweep_store.h"

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;
using traces::testing::TempFolder;

/// A plan with one parameter, its values in MHz. The points live as long as the test program.
const std::vector<SweepPoint>& plan_of(const std::vector<int>& clocks) {
  struct Plan {
    traces::testing::AslFolder data;
    SweepInputs inputs{".", ProgressLine::Style::None};
    SweepPlan plan;
    std::optional<Expansion> expansion;
  };
  static std::map<std::vector<int>, Plan> plans;
  const auto [entry, is_new] = plans.try_emplace(clocks);
  Plan& plan = entry->second;
  if (is_new) {
    plan.plan = parse_plan("plan.yaml",
                           fmt::format("base: {{ data: {}, platform: gap9, size: 32x24 }}\n"
                                       "points: {{ grid: {{ platform.cluster.clock: [{}] }} }}\n",
                                       plan.data.root().string(), fmt::join(clocks, ", ")),
                           plan.inputs);
    plan.expansion.emplace(expand(plan.plan, plan.inputs));
  }
  return plan.expansion->points;
}

void publish(SweepStore& store, const TempFolder& folder) {
  outputs::OutputFile csv(
      {.option = "--out", .path = (folder / kSweepCsv).string(), .replace = true, .inputs = {}});
  EXPECT_FALSE(store.publish(csv).has_value());
}

Outcome result_of(double latency_ms, double l1_bytes = 1000) {
  return {"",
          {{"objective.frame_time", "ms", "of a frame", latency_ms},
           {"objective.l1_peak", "byte", "peak", l1_bytes}}};
}

double latency(SweepStore& store, int point) {
  for (const SweepOutcome& outcome : store.outcomes())
    if (outcome.point == point) return outcome.objectives[0].value();
  ADD_FAILURE() << "point " << point << " is not finished";
  return 0;
}

TEST(SweepStore, TheSamePlanGoesOnWhereItWas) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(2, result_of(5));
  SweepStore again(folder.path(), "plan", plan_of({100, 200}));
  EXPECT_EQ(again.finished(), std::set<int>{2});
  EXPECT_EQ(again.planned(), 2);
  EXPECT_EQ(again.settings_of(1), "platform.cluster.clock=100MHz");
}

TEST(SweepStore, APlanOfTheSameSizeWithOtherValuesIsAnother) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(1, result_of(5));
  for (const std::vector<int>& other :
       {std::vector{100, 300}, std::vector{200, 100}, std::vector{100}, std::vector{100, 200, 300}})
    expect_input_error([&] { SweepStore(folder.path(), "plan", plan_of(other)); },
                       {"sweep.sqlite", "another plan"});
  SweepStore kept(folder.path());
  EXPECT_EQ(kept.planned(), 2);
  EXPECT_EQ(kept.settings_of(2), "platform.cluster.clock=200MHz");
}

TEST(SweepStore, RemembersWhereThePlanLiesAlsoAfterAMerge) {
  const TempFolder folder;
  const auto in = [&](const char* name) { return folder.path() / name; };
  SweepStore store(in("swept"), "plan", plan_of({100, 200}));
  EXPECT_EQ(store.place(), std::nullopt);
  store.keep_place(in("plan.yaml"));
  EXPECT_EQ(store.place(), std::filesystem::weakly_canonical(in("plan.yaml")));
  std::filesystem::create_directories(in("deep/er"));
  store.copy_plan_to(in("deep/er"));
  EXPECT_EQ(SweepStore(in("deep/er")).place(), store.place());
  EXPECT_EQ(store.plan_text(), "plan");
  EXPECT_EQ(store.key_of(2), plan_of({100, 200})[1].key);
  EXPECT_EQ(store.key_of(3), "");
}

TEST(SweepStore, RefusesOtherVersions) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100})).put(1, result_of(5));
  for (const char* format : {"leviosim sweep 1", "leviosim sweep 3"}) {
    Database(folder / kSweepFile, Database::Mode::existing)
        .run(std::string("UPDATE sweep SET value = '") + format + "' WHERE name = 'format'");
    expect_input_error([&] { SweepStore(folder.path()); }, {"not known", kSweepFormat});
  }
}

TEST(SweepStore, OfTwoResultsOfAPointTheFirstStays) {
  const TempFolder folder;
  SweepStore store(folder.path(), "plan", plan_of({100}));
  store.put(1, result_of(5));
  store.put(1, result_of(6));
  EXPECT_EQ(latency(store, 1), 5);
}

TEST(SweepStore, AMergeTakesWhatIsMissing) {
  const TempFolder a, b;
  SweepStore ours(a.path(), "plan", plan_of({100, 200, 300}));
  SweepStore theirs(b.path(), "plan", plan_of({100, 200, 300}));
  ours.put(1, result_of(5));
  theirs.put(1, result_of(5));  // the same, by both
  theirs.put(3, {"too little L1", {}});
  ours.merge(theirs);
  EXPECT_EQ(ours.finished(), (std::set<int>{1, 3}));
  EXPECT_EQ(ours.outcomes().back().failure, "too little L1");
}

TEST(SweepStore, AMergeRefusesDifferentResultsOfAPointAndTakesNothing) {
  struct {
    const char* what;
    Outcome result;
  } const others[] = {
      {"another value", result_of(5.5)},
      {"a failure", {"too little L1", {}}},
      {"a figure less", {"", {result_of(5).figures[0]}}},
  };
  for (const auto& other : others) {
    SCOPED_TRACE(other.what);
    const TempFolder a, b;
    SweepStore ours(a.path(), "plan", plan_of({100, 200}));
    SweepStore theirs(b.path(), "plan", plan_of({100, 200}));
    theirs.put(1, result_of(4));
    ours.put(2, result_of(5));
    theirs.put(2, other.result);
    expect_input_error([&] { ours.merge(theirs); },
                       {b.path().string(), "other results for point 2", a.path().string()});
    EXPECT_EQ(ours.finished(), std::set<int>{2});
    EXPECT_EQ(latency(ours, 2), 5);
  }
}

TEST(SweepStore, AMergeRefusesAnotherPlan) {
  const TempFolder a, b;
  SweepStore ours(a.path(), "plan", plan_of({100, 200}));
  SweepStore theirs(b.path(), "plan", plan_of({100, 300}));
  theirs.put(1, result_of(4));
  expect_input_error([&] { ours.merge(theirs); }, {"another plan"});
  EXPECT_TRUE(ours.finished().empty());
}

/// Points that several jobs compute are finished in any order, and have figures of their own.
TEST(SweepStore, TheFileDoesNotDependOnTheOrderInWhichPointsWereFinished) {
  std::map<int, Outcome> results{
      {1, result_of(5)}, {2, {"too little L1", {}}}, {3, result_of(3)}, {4, result_of(4, 900)}};
  results[3].figures.insert(results[3].figures.begin(), {"accuracy.tilt", "deg", "of it", 0.5});
  results[4].figures.push_back({"accuracy.ate", "m", "of it", 0.25});
  const std::vector<int> clocks{100, 200, 300, 350};
  std::set<std::string> files;
  for (const std::vector<int>& order : {std::vector{1, 2, 3, 4}, {4, 3, 2, 1}, {3, 1, 4, 2}}) {
    const TempFolder folder;
    SweepStore store(folder.path(), "plan", plan_of(clocks));
    for (const int point : order) store.put(point, results[point]);
    publish(store, folder);
    for (const auto& [point, result] : results)
      EXPECT_EQ(to_text(*store.result_of(point)), to_text(result)) << point;
    files.insert(base::read_text_file(folder / kSweepFile));
  }
  EXPECT_EQ(files.size(), 1u);
}

TEST(SweepStore, TheFrontIsThatOfTheLastPublication) {
  const TempFolder folder;
  SweepStore store(folder.path(), "plan", plan_of({100, 200, 300}));
  store.put(1, result_of(5, 1000));
  publish(store, folder);
  EXPECT_EQ(store.front(), std::set<int>{1});
  store.put(2, result_of(4, 900));   // better in all
  store.put(3, result_of(3, 2000));  // faster, but larger
  publish(store, folder);
  EXPECT_EQ(store.front(), (std::set<int>{2, 3}));
}

}  // namespace
}  // namespace leviosim::tools
