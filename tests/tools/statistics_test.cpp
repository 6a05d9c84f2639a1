#include "tools/app/record/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/tools/example_run.h"
#include "tests/tools/statistic_values.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

using testing::example_run;
using testing::value;

TEST(Statistics, EachHasNameUnitDescriptionValueAndNamesAreUnique) {
  std::set<std::string> names;
  const RunFigures figures = figures_of(example_run());
  ASSERT_FALSE(figures.statistics.empty());
  for (const Statistic& statistic : figures.statistics) {
    EXPECT_FALSE(statistic.unit.empty()) << statistic.name;
    EXPECT_FALSE(statistic.description.empty()) << statistic.name;
    EXPECT_TRUE(names.insert(statistic.name).second) << statistic.name;
  }
}

TEST(Statistics, ValuesAreThoseOfTheRun) {
  const RunFigures document = figures_of(example_run());
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
  const RunFigures document = figures_of(run);
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
  const RunFigures document = figures_of(run);
  std::int64_t sources = 0, kinds = 0;
  for (const Statistic& s : document.statistics) {
    if (s.name.starts_with("frames.source.")) sources += std::llround(s.value.value());
    if (s.name.starts_with("latency.") && s.name.ends_with(".frames"))
      kinds += std::llround(s.value.value());
  }
  EXPECT_EQ(sources, std::ssize(run.frames));
  EXPECT_EQ(kinds, std::ssize(run.frames));
}

TEST(Statistics, WhatDoesNotExistIsNull) {
  const RunFigures document = figures_of(example_run());
  EXPECT_FALSE(value(document, "stages.epnp_ransac.speedup"));
  EXPECT_FALSE(value(document, "stages.epnp_ransac.cycles.parallel.mean"));
  EXPECT_FALSE(value(document, "latency.epnp_keyframe.mean"));
}

TEST(Statistics, BreakdownPartsAddUpToTheirTotal) {
  const RunFigures document = figures_of(example_run());
  const std::string prefix = "stages.feature_extraction.breakdown.";
  double sum = 0;
  for (const sim::MechanismInfo& part : breakdown_parts(example_run()))
    sum += value(document, prefix + std::string(part.key)).value();
  EXPECT_DOUBLE_EQ(sum, value(document, prefix + "total").value());
}

TEST(Statistics, AccuracyNeverAppearsWithoutItsProtocol) {
  const RunResult run = example_run();
  int figures = 0;
  const RunFigures known = figures_of(run);
  for (const Statistic& s : known.statistics)
    if (s.name.starts_with("accuracy.")) {
      ++figures;
      EXPECT_EQ(s.protocol, run.ate->protocol);
    }
  EXPECT_GE(figures, 5);
}

TEST(Statistics, DependNeitherOnTheHostNorOnTiming) {
  RunResult run = example_run();
  const std::string before = testing::figures_text(run);
  run.host_seconds = 99;
  EXPECT_EQ(testing::figures_text(run), before);
  run.timed = false;
  EXPECT_EQ(testing::figures_text(run).find("cycles"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
