// The arithmetic of comparisons on records made by hand.
#include "tools/app/comparison/comparison.h"
#include "sim/work/op.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/comparison/stage_difference.h"

#include <gtest/gtest.h>

#include "tests/tools/example_run.h"
#include "tools/app/record/record.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {
namespace {

using testing::example_run;

StageParts stage(double cycles, std::vector<CyclePart> parts) {
  return {"s", false, cycles, std::move(parts)};
}

const ComparedQuantity& part(const ComparedQuantity& whole, const std::string& name) {
  static const ComparedQuantity none;
  for (const ComparedQuantity& q : whole.parts)
    if (q.name == name) return q;
  ADD_FAILURE() << "no part " << name;
  return none;
}

TEST(CycleDifference, WorkIsAtTheCostInAAndTheRestIsCost) {
  // 100 operations at 2 cycles, then 150 at 3; and 40 cycles of waiting more.
  const StageParts a = stage(200, {{"f", "issue", "int_alu", 200, 100}});
  const StageParts b = stage(490, {{"f", "issue", "int_alu", 450, 150}, {"", "fpu", "", 40, 0}});
  const Causes causes = split_by_cause(&a, &b, 1, 1);
  EXPECT_EQ(causes.work, 100);
  EXPECT_EQ(causes.cost, 150);
  EXPECT_EQ(causes.contention, 40);
  const ComparedQuantity whole = split_by_mechanism(&a, &b, 1, 1);
  EXPECT_EQ(part(part(whole, "issue"), "int_alu").difference(), 250);
  EXPECT_EQ(part(whole, "fpu").difference(), 40);
  const ComparedQuantity places = split_by_fork(&a, &b, 1, 1);
  EXPECT_EQ(part(places, "f").difference(), 250);
}

TEST(CycleDifference, WhatNoPartExplainsIsTheRest) {
  const StageParts a = stage(100, {{"f", "issue", "int_alu", 100, 10}});
  const StageParts b = stage(150, {{"f", "issue", "int_alu", 120, 10}});
  EXPECT_EQ(part(split_by_mechanism(&a, &b, 1, 1), "rest").difference(), 30);
  EXPECT_EQ(split_by_cause(&a, &b, 1, 1).total(), 50);
}

TEST(CycleDifference, IsThatOfAMeanFrame) {
  const StageParts a = stage(100, {{"", "fpu", "", 100, 0}});
  const StageParts b = stage(100, {{"", "fpu", "", 100, 0}});
  EXPECT_EQ(split_by_mechanism(&a, &b, 10, 5).difference(), 10);
}

TEST(CycleDifference, OfAStageThatOneRunLacksIsAllWork) {
  const StageParts b = stage(30, {{"f", "issue", "int_alu", 30, 10}});
  EXPECT_EQ(split_by_cause(nullptr, &b, 1, 1).work, 30);
  EXPECT_EQ(split_by_mechanism(nullptr, &b, 1, 1).difference(), 30);
}

TEST(CycleDifference, FoldedPartsStillAddUp) {
  const StageParts full = stage(
      100,
      {{"f", "issue", "int_alu", 90, 10}, {"f", "issue", "call", 6, 1}, {"", "fpu", "", 4, 0}});
  const StageParts less = folded(full, 0.05);
  ASSERT_EQ(less.parts.size(), 3u);
  EXPECT_EQ(less.parts.back().mechanism, "other");
  EXPECT_EQ(less.parts.back().cycles, 4);
  const StageParts like = folded_like(full, folded(full, 0.5));
  ASSERT_EQ(like.parts.size(), 2u);
  EXPECT_EQ(like.parts.back().cycles, 10);
}

RunRecord record(const RunResult& run) {
  Manifest manifest;
  manifest.platform = "gap9";
  manifest.inputs = {{"cam0/data.csv", 1, "abc"}};
  return make_record("run", manifest, run);
}

TEST(RunRecord, FramesAndMemoriesTogether) {
  const RunRecord r = record(example_run());  // latencies of 10, 20, 60, 30, 40 ms
  EXPECT_EQ(r.value("frame.latency.p50"), 30e6);
  EXPECT_EQ(r.value("frame.latency.worst"), 60e6);
  EXPECT_EQ(r.value("frame.latency.mean"), 32e6);
  EXPECT_EQ(r.value("frame.missed_share"), 0.2);  // one of five above 50 ms
  EXPECT_EQ(r.value("memory.l1.peak"), 64'000);   // the optimiser's is L2
  EXPECT_EQ(r.value("memory.l2.peak"), 50'900 + 743'600);
  EXPECT_EQ(r.value("stages.feature_extraction.operations"), 12'345);
  ASSERT_EQ(r.stages.size(), 3u);
  EXPECT_TRUE(r.stages[2].on_controller);
}

TEST(RunRecord, OfARunInMemoryIsThatOfItsFolder) {
  Manifest manifest;
  manifest.seed = 7;
  manifest.platform = "gap9";
  manifest.overrides = {"cluster.l1_size=64 KiB"};
  manifest.workload = {"workload.window=6"};
  manifest.first_frame = 3;
  manifest.inputs = {{"cam0/data.csv", 1, "abc"}, {"imu0/data.csv", 2, "def"}};
  const auto expect_same = [&](const RunResult& run) {
    const RunRecord made = make_record("run", manifest, run);
    const RunRecord read = parse_record("run.json", record_text(made), Level::all);
    EXPECT_EQ(record_text(read), record_text(made));
    EXPECT_EQ(read.facts, made.facts);
    ASSERT_EQ(read.stages.size(), made.stages.size());
    for (std::size_t i = 0; i < read.stages.size(); ++i) {
      EXPECT_EQ(read.stages[i].name, made.stages[i].name);
      EXPECT_EQ(read.stages[i].key, made.stages[i].key);
      EXPECT_EQ(read.stages[i].on_controller, made.stages[i].on_controller);
    }
    ASSERT_EQ(read.statistics.size(), made.statistics.size());
    for (std::size_t i = 0; i < read.statistics.size(); ++i) {
      EXPECT_EQ(read.statistics[i].name, made.statistics[i].name);
      EXPECT_EQ(read.statistics[i].unit, made.statistics[i].unit) << made.statistics[i].name;
      EXPECT_EQ(read.statistics[i].value, made.statistics[i].value) << made.statistics[i].name;
    }
  };
  RunResult run = example_run();
  expect_same(run);
  run.camera = CameraRecord{12.5, Deadline::Drop, {}};
  for (const FrameResult& f : run.frames)
    run.camera->deliveries.push_back({f.index, f.t_ns, f.arrival_ns, 0, false});
  run.camera->deliveries.push_back({5, 250'000'000, 250'000'000, 2, true});
  expect_same(run);
  Json input;
  input["name"] = "cam0/data.csv";
  input["sha256"] = "of the recording";
  manifest.recording["inputs"] = Json::array();
  manifest.recording["inputs"].push_back(input);
  run.camera.reset();
  expect_same(run);
  run.timed = false;
  expect_same(run);
}

TEST(RunRecord, DroppedFramesAreMissed) {
  RunResult run = example_run();
  run.camera = CameraRecord{};
  run.camera->fps = 20;
  for (const FrameResult& f : run.frames)
    run.camera->deliveries.push_back({f.index, f.t_ns, f.arrival_ns, 0, false});
  run.camera->deliveries.push_back({5, 0, 250'000'000, 2, true});
  EXPECT_DOUBLE_EQ(record(run).value("frame.missed_share").value(), 2.0 / 6);
}

TEST(Comparison, WorkHasChangedWhereOperationsOrCallsHave) {
  const RunRecord a = record(example_run());
  RunResult more = example_run();
  more.stages[0].counts[work::Op::F32Add] += 5;
  const RunRecord b = record(more);
  EXPECT_TRUE(compare_runs(a, a).same_work());
  const RunComparison c = compare_runs(a, b);
  EXPECT_FALSE(c.same_work());
  EXPECT_NE(work_line(c).find("CHANGED in 1 of 3 stages"), std::string::npos) << work_line(c);
  RunResult other_kind = example_run();  // as many operations, but others
  other_kind.stages[0].counts[work::Op::F32Add] -= 5;
  other_kind.stages[0].counts[work::Op::F32Mul] += 5;
  const RunRecord other = record(other_kind);
  EXPECT_FALSE(compare_runs(a, other).same_work());
}

TEST(Comparison, NamesBlocksThatGrewOrAppeared) {
  RunResult more = example_run();
  more.stages[0].memory.blocks.push_back(testing::block("table", 500));
  more.stages[0].memory.blocks[0].size = Bytes(20'000);
  const RunRecord a = record(example_run());
  const RunRecord b = record(more);
  const RunComparison c = compare_runs(a, b);
  ASSERT_EQ(c.blocks.size(), 2u);
  EXPECT_EQ(c.blocks[0].name, "feature extraction: image");
  EXPECT_EQ(c.blocks[0].difference(), 800);
  EXPECT_EQ(c.blocks[1].name, "feature extraction: table");
  EXPECT_FALSE(c.blocks[1].a.has_value());
}

TEST(Comparison, RunsWithoutPartsSayThatTheirMechanismsAreUnknown) {
  RunRecord a = record(example_run());
  a.cycles.clear();
  EXPECT_NE(comparison_report(compare_runs(a, a), ReportFormat::text).find("is not known"),
            std::string::npos);
}

TEST(Comparison, ARecordWithoutSumsHasSharesToo) {  // as baselines are
  RunRecord a = record(example_run());
  std::erase_if(a.statistics, [](const Statistic& s) { return s.name.ends_with(".sum"); });
  const RunRecord b = record(example_run());
  const RunComparison c = compare_runs(a, b);
  ASSERT_TRUE(c.stages[0].share.a.has_value());
  EXPECT_EQ(c.stages[0].share.a, c.stages[0].share.b);
}

TEST(Comparison, CyclesMeasuredOfNoKnownNumberOfFramesHaveNoShares) {
  RunRecord measured = record(example_run());
  std::erase_if(measured.statistics, [](const Statistic& s) { return s.name == "frames.count"; });
  measured.facts.frames = 0;
  const RunRecord b = record(example_run());
  const RunComparison c = compare_runs(measured, b);
  EXPECT_FALSE(c.stages[0].share.a.has_value());
  EXPECT_TRUE(c.stages[0].share.b.has_value());
}

TEST(Comparison, AStageThatDidNotRunHasNoRow) {
  RunResult run = example_run();
  const std::string name = "\nEPnP RANSAC ";
  const RunRecord without = record(run);
  run.stages[1].calls = 5;
  const RunRecord with = record(run);
  const auto report = [&](const RunRecord& b) {
    return comparison_report(compare_runs(without, b), ReportFormat::text);
  };
  EXPECT_EQ(report(without).find(name), std::string::npos) << report(without);
  EXPECT_NE(report(with).find(name), std::string::npos) << report(with);
}

}  // namespace
}  // namespace leviosim::tools
