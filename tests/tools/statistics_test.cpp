#include "tools/app/report/statistics.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/tools/example_run.h"
#include "tests/tools/statistic_values.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

using testing::example_run;
using testing::statistic;
using testing::value;

TEST(Statistics, EachHasNameUnitDescriptionValueAndNamesAreUnique) {
  std::set<std::string> names;
  const Json document = statistics(example_run());
  ASSERT_FALSE(document.at("statistics").empty());
  for (const Json& entry : document.at("statistics")) {
    for (const char* key : {"name", "unit", "description", "value"})
      EXPECT_TRUE(entry.contains(key)) << entry.dump();
    EXPECT_FALSE(entry.at("description").get<std::string>().empty()) << entry.dump();
    EXPECT_TRUE(names.insert(entry.at("name").get<std::string>()).second) << entry.at("name");
  }
}

TEST(Statistics, ValuesAreThoseOfTheRun) {
  const Json document = statistics(example_run());
  EXPECT_EQ(value(document, "stages.feature_extraction.calls"), 2);
  EXPECT_EQ(value(document, "stages.feature_extraction.cycles.single.sum"), 8'000'000);
  EXPECT_EQ(value(document, "stages.feature_extraction.cycles.single.mean"), 4e6);
  EXPECT_EQ(value(document, "stages.feature_extraction.speedup"), 4.0);
  EXPECT_EQ(value(document, "stages.feature_extraction.time.parallel.mean"), 10.0);
  EXPECT_EQ(value(document, "stages.feature_extraction.ops.f32_add"), 12'345);
  EXPECT_EQ(value(document, "stages.feature_extraction.memory.block.scratch"), 20'000);
  EXPECT_EQ(value(document, "stages.optimiser_iteration.time.parallel.mean"), 10.0);
  EXPECT_EQ(value(document, "latency.epnp.mean"), 35e6);
  EXPECT_EQ(value(document, "latency.eight_point_keyframe.worst"), 60'000'000);
  EXPECT_EQ(value(document, "latency.eight_point_keyframe.over_period"), 1);
  EXPECT_EQ(value(document, "memory.l2.optimiser.bytes"), 743'600);
  EXPECT_EQ(value(document, "trajectory.length"), 2.0);
  EXPECT_EQ(value(document, "frames.keyframes"), 2);
}

TEST(Statistics, FactsOfFramesAreSummedUp) {
  RunResult run = example_run();
  run.frames[1].map_restarts = run.frames[4].map_restarts = 1;
  const Json document = statistics(run);
  EXPECT_EQ(value(document, "frames.map_restarts.sum"), 2);
  EXPECT_EQ(value(document, "frames.landmarks.sum"), 5 * 200);
}

TEST(Statistics, EveryFrameHasASourceAndAKind) {
  RunResult run = example_run();
  run.frames.clear();
  for (int k = 0; k <= static_cast<int>(PoseSource::Tracked); ++k) {
    const auto source = static_cast<PoseSource>(k);
    EXPECT_EQ(vio::source_named(name_of(source)), source);
    run.frames.push_back(testing::frame(k, source, false, 10'000'000));
  }
  EXPECT_EQ(vio::source_named("guessed"), std::nullopt);
  const Json document = statistics(run);
  std::int64_t sources = 0, kinds = 0;
  for (const Json& entry : document.at("statistics")) {
    const auto name = entry.at("name").get<std::string>();
    if (name.starts_with("frames.source.")) sources += entry.at("value").get<std::int64_t>();
    if (name.starts_with("latency.") && name.ends_with(".frames"))
      kinds += entry.at("value").get<std::int64_t>();
  }
  EXPECT_EQ(sources, std::ssize(run.frames));
  EXPECT_EQ(kinds, std::ssize(run.frames));
}

TEST(Statistics, WhatDoesNotExistIsNull) {
  const Json document = statistics(example_run());
  EXPECT_TRUE(value(document, "stages.epnp_ransac.speedup").is_null());
  EXPECT_TRUE(value(document, "stages.epnp_ransac.cycles.parallel.mean").is_null());
  EXPECT_TRUE(value(document, "latency.epnp_keyframe.mean").is_null());
}

TEST(Statistics, BreakdownPartsAddUpToTheirTotal) {
  const Json document = statistics(example_run());
  const std::string prefix = "stages.feature_extraction.breakdown.";
  double sum = 0;
  for (const sim::MechanismInfo& part : breakdown_parts(example_run()))
    sum += value(document, prefix + std::string(part.key)).get<double>();
  EXPECT_DOUBLE_EQ(sum, value(document, prefix + "total").get<double>());
}

TEST(Statistics, AccuracyNeverAppearsWithoutItsProtocol) {
  const RunResult run = example_run();
  const Json document = statistics(run);  // named, because the loop keeps no temporary alive
  int figures = 0;
  for (const Json& entry : document.at("statistics"))
    if (entry.at("name").get<std::string>().rfind("accuracy.", 0) == 0) {
      ++figures;
      EXPECT_EQ(entry.at("protocol"), run.ate->protocol);
    }
  EXPECT_GE(figures, 5);
}

TEST(Statistics, DependNeitherOnTheHostNorOnTiming) {
  RunResult run = example_run();
  const std::string before = statistics(run).dump();
  run.host_seconds = 99;
  EXPECT_EQ(statistics(run).dump(), before);
  run.timed = false;
  EXPECT_EQ(statistics(run).dump().find("cycles"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
