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

namespace fs = std::filesystem;
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

RunRecord result_of(double latency_ms, double l1_bytes = 1000) {
  RunRecord record;
  record.statistics = {{.name = "frame.time.mean", .unit = "ns", .value = latency_ms * 1e6},
                       {.name = "memory.l1.peak", .unit = "byte", .value = l1_bytes}};
  return record;
}

RunRecord failed(const std::string& why) {
  RunRecord record;
  record.failure = why;
  return record;
}

RunRecord without_a_figure(RunRecord record) {
  record.statistics.pop_back();
  return record;
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
  EXPECT_EQ(again.settings_of(2), "platform.cluster.clock=200MHz");
}

TEST(SweepStore, APlanOfTheSameSizeWithOtherValuesIsAnother) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(1, result_of(5));
  for (const std::vector<int>& other :
       {std::vector{100, 300}, std::vector{200, 100}, std::vector{100}, std::vector{100, 200, 300}})
    expect_input_error([&] { SweepStore(folder.path(), "plan", plan_of(other)); },
                       {"points.jsonl", "another plan"});
  const SweepStore kept(folder.path());
  EXPECT_EQ(kept.planned(), 2);
  EXPECT_TRUE(kept.holds(plan_of({100, 200})));
  EXPECT_FALSE(kept.holds(plan_of({100, 300})));
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
}

TEST(SweepStore, RefusesOtherVersions) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100})).put(1, result_of(5));
  const std::string text = base::read_text_file(folder / kSweepFile);
  for (const char* version : {"1", "3", "5", "30"}) {
    std::string other = text;
    other.replace(other.find("sweep 4"), 7, std::string("sweep ") + version);
    outputs::write_file_atomically(folder / kSweepFile, other);
    expect_input_error([&] { SweepStore(folder.path()); }, {"not known", kSweepFormat});
  }
  std::filesystem::rename(folder / kSweepFile, folder / kOldSweepFile);
  expect_input_error([&] { SweepStore(folder.path()); }, {kOldSweepFile, "new folder"});
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
  theirs.put(3, failed("too little L1"));
  ours.merge(theirs);
  EXPECT_EQ(ours.finished(), (std::set<int>{1, 3}));
  EXPECT_EQ(ours.outcomes().back().failure, "too little L1");
}

TEST(SweepStore, AMergeRefusesDifferentResultsOfAPointAndTakesNothing) {
  struct {
    const char* what;
    RunRecord result;
  } const others[] = {
      {"another value", result_of(5.5)},
      {"a failure", failed("too little L1")},
      {"a figure less", without_a_figure(result_of(5))},
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
TEST(SweepStore, TheTableDoesNotDependOnTheOrderInWhichPointsWereFinished) {
  std::map<int, RunRecord> results{
      {1, result_of(5)}, {2, failed("too little L1")}, {3, result_of(3)}, {4, result_of(4, 900)}};
  results[3].statistics.insert(results[3].statistics.begin(),
                               {.name = "accuracy.tilt", .unit = "deg", .value = 0.5});
  results[4].statistics.push_back({.name = "accuracy.ate", .unit = "m", .value = 0.25});
  const std::vector<int> clocks{100, 200, 300, 350};
  std::set<std::string> files;
  for (const std::vector<int>& order : {std::vector{1, 2, 3, 4}, {4, 3, 2, 1}, {3, 1, 4, 2}}) {
    const TempFolder folder;
    SweepStore store(folder.path(), "plan", plan_of(clocks));
    for (const int point : order) store.put(point, results[point]);
    publish(store, folder);
    for (const auto& [point, result] : results)
      EXPECT_EQ(record_json(*store.result_of(point)), record_json(result)) << point;
    files.insert(base::read_text_file(folder / kSweepCsv));
  }
  EXPECT_EQ(files.size(), 1u);
}

/// A process that was killed while it wrote, at every byte: whole points count, and the next goes
/// on.
TEST(SweepStore, ALineThatLacksItsEndDoesNotCount) {
  const TempFolder folder;
  const fs::path file = folder / kSweepFile;
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(1, result_of(5));
  const std::string one = base::read_text_file(file);
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(2, result_of(4));
  const std::string both = base::read_text_file(file);
  for (std::size_t size = one.size(); size <= both.size(); ++size) {
    outputs::write_file_atomically(file, both.substr(0, size));
    SweepStore store(folder.path(), "plan", plan_of({100, 200}));
    EXPECT_EQ(store.finished().size(), size == both.size() ? 2u : 1u) << size;
    store.put(2, result_of(4));
    EXPECT_EQ(base::read_text_file(file), both) << size;
  }
}

/// What others do to the file while a process has it open.
TEST(SweepStore, GoesOnInWhatHasTheName) {
  const TempFolder folder;
  const fs::path file = folder / kSweepFile;
  SweepStore store(folder.path(), "plan", plan_of({100, 200, 300}));
  store.put(1, result_of(5));
  const std::string one = base::read_text_file(file);
  fs::rename(file, folder / "moved");  // as a backup does
  store.put(2, result_of(4));
  EXPECT_EQ(base::read_text_file(folder / "moved"), one);
  EXPECT_EQ(SweepStore(folder.path()).finished(), std::set<int>{2});
  SweepStore(folder.path(), "plan", plan_of({100, 200, 300})).put(1, result_of(5));
  store.put(3, result_of(3));
  EXPECT_EQ(store.finished(), (std::set<int>{1, 2, 3}));
  fs::create_hard_link(file, folder / "linked");
  expect_input_error([&] { store.put(1, result_of(5)); }, {kSweepFile, "2 names"});
  fs::remove(folder / "linked");
  fs::remove(file);
  SweepStore(folder.path(), "plan", plan_of({100}));  // another sweep began there
  const std::string other = base::read_text_file(file);
  expect_input_error([&] { store.put(2, result_of(4)); }, {"another plan"});
  EXPECT_EQ(base::read_text_file(file), other);
}

TEST(SweepStore, RefusesDamagedLines) {
  const TempFolder folder;
  SweepStore(folder.path(), "plan", plan_of({100, 200})).put(1, result_of(5));
  const std::string text = base::read_text_file(folder / kSweepFile);
  const std::string first = text.substr(0, text.find('\n') + 1);
  const std::string point = text.substr(first.size());
  std::string other = point;
  other.replace(other.find("\"record\":{"), 10, "\"record\":{\"failure\":\"x\",");
  std::string beyond = point;
  beyond.replace(beyond.find(":1,"), 3, ":3,");
  std::string settings = point;
  settings.replace(settings.find("\"set\":["), 7, "\"set\":[[\"a\",\"b\"],");
  for (const auto& [lines, fault] : std::vector<std::pair<std::string, std::string>>{
           {point, "no file of leviosim sweep"},
           {first + point + other, "other results for point 1"},
           {first + beyond, "point 3"},
           {first + settings, "parameters"},
           {first + "{}\n", "expected a line"},
           {first + std::string(70'000, '[') + "\n", "levels"},
           {first + "{\"point\":1,\"key\":\"k\",\"set\":[" + std::string(300'000, '0') + "\n",
            "JSON"},
           {first + std::string(5 << 20, 'x') + "\n", "more than"},
           {first + "\n\n" + point.substr(0, 40) + "\n", "JSON"}}) {
    outputs::write_file_atomically(folder / kSweepFile, lines);
    expect_input_error([&] { SweepStore(folder.path()); }, {kSweepFile, fault});
  }
}

}  // namespace
}  // namespace leviosim::tools
