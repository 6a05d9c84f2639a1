// From frames to the figures that are compared: which frames an average is over, and how.

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"
#include "tests/validation/example_log.h"
#include "tools/app/validation/distributions.h"
#include "tools/app/validation/paper_stages.h"
#include "tools/app/validation/quantities.h"
#include "tools/app/validation/run_inputs.h"
#include "tools/app/validation/validation.h"
#include "tools/app/validation/validation_report.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using testing::example_log;
using testing::example_run;
using traces::testing::expect_input_error;

std::optional<double> value(const std::vector<Quantity>& quantities, const std::string& name) {
  for (const Quantity& quantity : quantities)
    if (quantity.name == name) return quantity.value;
  ADD_FAILURE() << name;
  return {};
}

std::vector<Quantity> example_quantities() { return quantities_of(example_run(), example_log()); }

const PaperStage& stage(std::string_view key) {
  for (const PaperStage& s : kPaperStages)
    if (s.key == key) return s;
  ADD_FAILURE() << key;
  return kPaperStages[0];
}

TEST(ValidationFrames, AveragesAreOverTheFramesThatTheyStandFor) {
  const FrameLog log = example_log();
  const auto frames = [&](const char* key) { return sum_over(log.frames(), stage(key)).frames; };
  EXPECT_EQ(frames("feature_extraction"), 4);
  EXPECT_EQ(frames("frame_matching"), 3);
  EXPECT_EQ(frames("world_matching"), 2);  // not the one that came to an empty map
  EXPECT_EQ(frames("epnp_ransac"), 2);     // also where its pose was refused
  EXPECT_EQ(frames("eight_point_ransac"), 2);
  EXPECT_EQ(frames("triangulation"), 1);  // not the first frame
}

TEST(ValidationFrames, CountsDescriptorPairs) {
  const FrameLog log = example_log();
  // Features of the frame × those of the last keyframe: 200 · 100, 300 · 200, 200 · 200.
  EXPECT_EQ(sum_over(log.frames(), stage("frame_matching")).pairs, 20'000 + 60'000 + 40'000);
  EXPECT_EQ(sum_over(log.frames(), stage("world_matching")).pairs, 300 * 80 + 200 * 80);
  EXPECT_EQ(sum_over(log.frames(), stage("epnp_ransac")).pairs, 0);
}

TEST(ValidationFrames, WorldMatchingIsTakenOverAllFrames) {
  FrameLog log = example_log();
  const auto add = [&](int landmarks) {
    testing::feed(log,
                  {PoseSource::Epnp, false, 100, landmarks, {{vio::stages::kWorldMatching, 1}}});
  };
  add(1000);
  add(900);
  add(899);
  add(1000);
  const StageSum sum = sum_over(log.frames(), stage("world_matching"));
  EXPECT_EQ(sum.frames, 6);
  // They came to what the frames before them left: three times 80, and then what was added.
  EXPECT_EQ(sum.landmarks, 3 * 80 + 1000 + 900 + 899);
}

TEST(ValidationQuantities, OfStagesAreMeans) {
  const std::vector<Quantity> q = example_quantities();
  EXPECT_DOUBLE_EQ(value(q, "compute.epnp_ransac.multi").value(), 40);
  EXPECT_DOUBLE_EQ(value(q, "compute.epnp_ransac.single").value(), 280);
  EXPECT_DOUBLE_EQ(value(q, "compute.epnp_ransac.speedup").value(), 7);
  EXPECT_DOUBLE_EQ(value(q, "compute.triangulation.multi").value(), 0.7);
  EXPECT_DOUBLE_EQ(value(q, "compute.imu_preintegration.per_sample").value(), 0.7);
}

TEST(ValidationQuantities, SharesAreOfTheSumOfMeans) {
  const std::vector<Quantity> q = example_quantities();
  const double rest = 10 + 2 + 4;  // extraction, frame and world matching
  EXPECT_DOUBLE_EQ(value(q, "share.epnp").value(), 100 * 40 / (rest + 40));
  EXPECT_DOUBLE_EQ(value(q, "share.eight_point").value(), 100 * 30 / (rest + 30));
}

TEST(ValidationQuantities, LatenciesAreOfOneKindOfFrame) {
  const std::vector<Quantity> q = example_quantities();  // 100 MHz
  EXPECT_DOUBLE_EQ(value(q, "latency.epnp").value(), 66'200 / 1e5);
  EXPECT_DOUBLE_EQ(value(q, "latency.eight_point_keyframe").value(), 52'800 / 1e5);
  EXPECT_FALSE(value(q, "latency.eight_point").has_value());  // that one ran both
  EXPECT_FALSE(value(q, "latency.epnp_keyframe").has_value());
  EXPECT_DOUBLE_EQ(value(q, "latency.mean").value(), (66'200 + 52'800 + 67'000) / 3.0 / 1e5);
}

TEST(ValidationQuantities, OfMemoryAreTheRunsPeaks) {
  const std::vector<Quantity> q = example_quantities();
  EXPECT_DOUBLE_EQ(value(q, "memory.feature_extraction.l1_parallel").value(), 64);
  EXPECT_DOUBLE_EQ(value(q, "memory.feature_extraction.occupation_parallel").value(), 50);
  EXPECT_DOUBLE_EQ(value(q, "memory.last_keyframe.l2").value(), 50.9);
  EXPECT_FALSE(value(q, "memory.epnp_ransac.l1_single").has_value());
}

TEST(ValidationQuantities, TheOptimiserIsJudgedByItsLongest) {
  FrameLog log = example_log();
  const auto iterate = [&](int frame, int k, std::int64_t cycles) {
    sim::JobTiming timing;
    timing.stages = {testing::stage_timing(vio::stages::kOptimiserUpdate, 999'999),
                     testing::stage_timing(vio::stages::kOptimiser, cycles)};
    log.on_optimiser({frame, k, k == 1, {}, timing});
  };
  iterate(1, 0, 200'000);
  iterate(1, 1, 300'000);
  iterate(2, 0, 400'000);
  const std::vector<Quantity> q = quantities_of(example_run(), log);  // 50 MHz
  EXPECT_DOUBLE_EQ(value(q, "compute.optimiser.longest_iteration").value(), 8);
  EXPECT_DOUBLE_EQ(value(q, "compute.optimiser.longest_frame").value(), 10);
}

TEST(ValidationQuantities, CoverAllReferencesOfThePaper) {
  const std::vector<Comparison> nothing = compare(paper_references(), quantities_of({}, {}));
  for (const Comparison& c : nothing) EXPECT_EQ(c.verdict, Verdict::NotCovered);
}

TEST(ValidationComparison, NamesWhatItDoesNotKnow) {
  const auto with = [](const std::string& name, const std::string& unit) {
    Reference r;
    r.name = name;
    r.value = 1;
    r.unit = unit;
    return std::vector<Reference>{r};
  };
  const std::vector<Quantity> q = example_quantities();
  expect_input_error([&] { compare(with("share.epnb", "%"), q); },
                     {"share.epnb", "did you mean 'share.epnp'"});
  expect_input_error([&] { compare(with("share.epnp", "ms"), q); }, {"unit 'ms'", "expected '%'"});
  expect_input_error([&] { compare(with("error.multi.mean", "%"), q); }, {"error.multi.mean"});
}

TEST(ValidationComparison, SummarisesAbsoluteErrors) {
  const std::vector<Reference> references = parse_references(
      "f.csv",
      "name,value,unit,tolerance,guard,status,source\n"
      "compute.a.multi,100,x,1 %,,met,s\ncompute.b.multi,100,x,1 %,,met,s\n"
      "compute.a.single,100,x,1 %,,met,s\n"
      "error.multi.mean,<12,%,0,,met,s\nerror.multi.worst,<12,%,0,20,missed: why,s\n");
  const std::vector<Comparison> c = compare(references, {{"compute.a.multi", "x", 110},
                                                         {"compute.b.multi", "x", 84},
                                                         {"compute.a.single", "x", 500}});
  EXPECT_DOUBLE_EQ(c[3].value.value(), 13);
  EXPECT_EQ(c[3].verdict, Verdict::Worse);
  EXPECT_DOUBLE_EQ(c[4].value.value(), 16);
  EXPECT_EQ(c[4].verdict, Verdict::Missed);
}

TEST(ValidationNormalised, DividesSumsByUnitsAndTellsWhatWouldExplainThePaper) {
  const vio::Profile profile = vio::profile_named("levio", 1);
  for (const NormalisedFigure& n : normalised(example_run(), example_log(), profile)) {
    if (n.stage == "frame matching") {
      EXPECT_DOUBLE_EQ(n.single.value(), 7 * 6'000 / 120'000.0);
      EXPECT_DOUBLE_EQ(n.parallel.value(), 6'000 / 120'000.0);
      EXPECT_DOUBLE_EQ(n.units.value(), 40'000);
      EXPECT_DOUBLE_EQ(n.explaining_units.value(), 8'112'000 / n.single.value());
    }
    if (n.stage == "EPnP RANSAC") {
      EXPECT_DOUBLE_EQ(n.units.value(), 64);
      EXPECT_FALSE(n.explaining_units.has_value());  // its number is known
    }
  }
}

std::size_t simulated_cells(const std::vector<InputDistribution>& distributions) {
  std::size_t cells = 0;
  for (const InputDistribution& distribution : distributions)
    for (const std::optional<double>& cell : distribution.simulated) cells += cell ? 1 : 0;
  return cells;
}

TEST(ValidationReport, FilesAndTablesHaveARowForEverything) {
  const Validation v =
      validate(example_run(), example_log(), vio::profile_named("levio", 1), paper_references());
  const std::string csv = validation_csv(v);
  const auto rows = static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n'));
  EXPECT_EQ(rows, 1 + v.comparisons.size() + v.inputs.size() + 2 * v.normalised.size() +
                      simulated_cells(v.distributions) + 2 * 3 * v.paths.size());
  EXPECT_NE(csv.find("reference,compute.epnp_ransac.multi,kcycles,10899,40,"), std::string::npos);
  const Json json = validation_json(v);
  EXPECT_EQ(json.at("comparisons").size(), v.comparisons.size());
  EXPECT_EQ(json.at("comparisons").at(0).at("name"), v.comparisons[0].reference.name);
  std::string text;
  for (const std::string& part : validation_report(v, 4)) text += part;
  for (const PaperStage& s : kPaperStages)
    EXPECT_NE(text.find(std::string(s.title)), std::string::npos);
  EXPECT_NE(text.find("not covered"), std::string::npos);
  EXPECT_EQ(json.at("distributions").size(), v.distributions.size());
  for (const InputDistribution& distribution : v.distributions)
    EXPECT_NE(text.find(distribution.quantity), std::string::npos);
  EXPECT_EQ(json.at("paths").size(), v.paths.size());
  EXPECT_NE(csv.find("path,feature extraction: N cores: EPnP,cycles,,11000,"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
