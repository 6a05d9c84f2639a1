#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "platform_models/loader/loader.h"
#include "sim/base/csv.h"
#include "tests/tools/example_run.h"
#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::example_run;
using traces::testing::TempFolder;

using Row = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (std::size_t comma = 0; comma != std::string::npos; begin = comma + 1) {
    comma = line.find(',', begin);
    cells.push_back(line.substr(begin, comma - begin));
  }
  return cells;
}

/// Rows by column name; every row must be as wide as the header.
std::vector<Row> parse_csv(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> header = split(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = split(line);
    EXPECT_EQ(cells.size(), header.size()) << line;
    Row row;
    for (std::size_t i = 0; i < std::min(cells.size(), header.size()); ++i)
      row[header[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

Manifest example_manifest() {
  Manifest manifest;
  manifest.command_line = {"run", "--platform", "gap9"};
  manifest.seed = 7;
  manifest.platform = "gap9";
  manifest.overrides = {"cluster.workers=4"};
  manifest.data = "flight";
  manifest.inputs = {{"cam0/data.csv", 3, "abc"}};
  return manifest;
}

void write_to(const fs::path& folder, const RunResult& run, const std::string& platform) {
  outputs::OutputFolder out({.option = {}, .path = folder.string()});
  write_run_folder(
      out, run_folder("out", std::make_shared<const RunResult>(run), example_manifest(), platform));
  EXPECT_FALSE(out.commit());
}

TEST(StagesCsv, HasARowPerStageAndBreakdownsThatAddUp) {
  const std::vector<Row> rows = parse_csv(csv_text(stage_rows(example_run())));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("stage"), "feature extraction");
  EXPECT_EQ(rows[0].at("speedup"), "4.000");
  EXPECT_EQ(rows[0].at("f32_add_ops"), "12345");
  EXPECT_EQ(rows[1].at("speedup"), "");
  EXPECT_EQ(rows[2].at("runs_on"), "controller");
  double sum = 0;
  for (const auto& [name, cell] : rows[0])
    if (name.size() > 12 && name.substr(name.size() - 12) == "_core_cycles") sum += std::stod(cell);
  EXPECT_DOUBLE_EQ(sum, 8e6);
}

TEST(FramesCsv, HasARowPerFrameAndLatenciesFromArrivalToPose) {
  const std::vector<Row> rows = parse_csv(csv_text(frame_rows(example_run())));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[3].at("source"), "epnp");
  EXPECT_EQ(rows[2].at("keyframe"), "1");
  EXPECT_EQ(rows[3].at("latency_ns"), "30000000");
  for (const Row& row : rows)
    EXPECT_EQ(std::stoll(row.at("end_ns")) - std::stoll(row.at("arrival_ns")),
              std::stoll(row.at("latency_ns")));
}

TEST(FramesCsv, EveryFactOfAFrameIsAColumn) {
  RunResult run = example_run();
  run.frames[3].map_restarts = 1;
  const std::vector<Row> rows = parse_csv(csv_text(frame_rows(run)));
  for (const vio::FrameFact& fact : vio::kFrameFacts)
    if (fact.words.empty()) {
      EXPECT_EQ(rows[3].at(std::string(fact.name)), std::to_string(run.frames[3].*fact.of));
    }
  run.frames[3].state = static_cast<int>(vio::PoseState::Predicted);
  EXPECT_EQ(rows[3].at("state"), "located");
  EXPECT_EQ(parse_csv(csv_text(frame_rows(run)))[3].at("state"), "predicted");
  run.frames[3].state = 17;  // of a trace that another program wrote
  EXPECT_EQ(parse_csv(csv_text(frame_rows(run)))[3].at("state"), "17");
  EXPECT_EQ(rows[2].at("map_restarts"), "0");
}

TEST(FramesCsv, HasTheCyclesOfEachStageOfTheCluster) {
  RunResult run = example_run();
  run.frame_stages = {"EPnP RANSAC", "feature extraction"};
  run.frames[3].stage_cycles = {Cycles(30), Cycles(700)};
  const std::vector<Row> rows = parse_csv(csv_text(frame_rows(run)));
  EXPECT_EQ(rows[3].at("cycles_feature_extraction"), "700");
  EXPECT_EQ(rows[3].at("cycles_epnp_ransac"), "30");
  EXPECT_EQ(rows[2].at("cycles_epnp_ransac"), "0");
  EXPECT_EQ(rows[3].count("cycles_optimiser_iteration"), 0u);
}

TEST(ErrorsCsv, HasARowPerPoseWithATruth) {
  RunResult run = example_run();
  EXPECT_EQ(csv_text(error_rows(run)), "");
  traces::MatchedPose pose;
  pose.t_ns = 5;
  pose.estimate.translation() = Eigen::Vector3d(3, 4, 1);
  pose.truth.translation() = Eigen::Vector3d(0, 0, 1);
  run.ate->poses = {pose};
  const std::vector<Row> rows = parse_csv(csv_text(error_rows(run)));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].at("t_ns"), "5");
  EXPECT_EQ(rows[0].at("position_error_m"), "5.000000000");
  EXPECT_EQ(rows[0].at("estimate_y_m"), "4.000000000");
  EXPECT_EQ(rows[0].at("truth_z_m"), "1.000000000");
}

TEST(FramesCsv, OfANativeRunHasNoTimingColumns) {
  RunResult run = example_run();
  run.timed = false;
  const std::vector<Row> rows = parse_csv(csv_text(frame_rows(run)));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].count("latency_ns"), 0u);
  EXPECT_EQ(rows[0].at("landmarks"), "200");
}

TEST(MemoryCsv, BlocksOfTheExampleAddUp) {
  const std::vector<Row> rows = parse_csv(csv_text(memory_rows(example_run())));
  std::int64_t bytes = 0;
  for (const Row& row : rows)
    if (row.at("owner") == "feature extraction" && row.at("what") == "block")
      bytes += std::stoll(row.at("bytes"));
  EXPECT_EQ(bytes, 39'200);
  EXPECT_EQ(rows.front().at("percent_of_nominal"), "25.000");
}

TEST(RunFolder, HoldsFilesThatParse) {
  const TempFolder folder;
  const platform::ResolvedPlatform platform = platform::resolve_platform("gap9");
  write_to(folder.path(), example_run(), platform::to_yaml(platform));
  const auto read = [&](const char* name) { return base::read_text_file(folder / name); };
  EXPECT_EQ(read("run.json"), record_text(make_record("r", example_manifest(), example_run())));
  const Json manifest = Json::parse(read("manifest.json"));
  EXPECT_EQ(manifest.at("seed"), 7);
  EXPECT_EQ(manifest.at("platform").at("overrides").at(0), "cluster.workers=4");
  EXPECT_EQ(manifest.at("inputs").at(0).at("sha256"), "abc");
  EXPECT_EQ(traces::read_tum(folder / "trajectory.tum").size(), 5u);
  EXPECT_EQ(read("stages.csv"), csv_text(stage_rows(example_run())));
  EXPECT_EQ(platform::resolve_platform((folder / "platform.yaml").string()).name, platform.name);
}

TEST(RunFolder, OnlyTheManifestsHostPartDependsOnTheHost) {
  const TempFolder folder;
  RunResult run = example_run();
  write_to(folder / "a", run, "x");
  run.host_seconds = 99;
  write_to(folder / "b", run, "x");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "a")) {
    const std::string name = entry.path().filename().string();
    if (name == outputs::kRecordName) continue;
    std::string a = base::read_text_file(folder / ("a/" + name));
    std::string b = base::read_text_file(folder / ("b/" + name));
    if (name == "manifest.json") {
      Json left = Json::parse(a);
      Json right = Json::parse(b);
      EXPECT_NE(left, right);
      left.erase("host");
      right.erase("host");
      a = left.dump();
      b = right.dump();
    }
    EXPECT_EQ(a, b) << name;
  }
}

TEST(RunFolder, OfANativeRunHasNoFilesAboutAChip) {
  const TempFolder folder;
  RunResult run = example_run();
  run.timed = false;
  write_to(folder.path(), run, "");
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
    names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{outputs::kRecordName, "manifest.json", "run.json",
                                          "frames.csv", "trajectory.tum"}));
  EXPECT_TRUE(Json::parse(base::read_text_file(folder / "manifest.json")).at("platform").is_null());
}

TEST(RunFolder, NothingIsLeftWhenWritingFails) {
  const TempFolder folder;
  {
    outputs::OutputFolder out({.option = "--out", .path = (folder / "out").string()});
    out.write("run.json", "x");  // where a file is to be written
    traces::testing::expect_input_error(
        [&] {
          write_run_folder(out, run_folder("", std::make_shared<const RunResult>(example_run()),
                                           example_manifest(), "x"));
        },
        {"run.json"});
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace leviosim::tools
