// `leviosim ablate` as users meet it.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "tests/support/run_program.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/ablation_table.h"
#include "tools/app/study/ablate/dimensions.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::contents;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(PublishedAccuracy, HoldsThePapersTables) {
  using Figure = PublishedAccuracy::Figure;
  const std::vector<PublishedAccuracy> paper = published_accuracy();
  EXPECT_EQ(paper.size(),
            45u + 30);  // 4 rows x 5 sequences x 2 figures, and QVGA; of others 6 rows
  double sum = 0;
  for (const PublishedAccuracy& p : paper)
    if (p.estimator == "levio" && p.size.width == 752 && p.chosen_by == Figure::ate &&
        p.figure == Figure::ate)
      sum += p.value;
  EXPECT_NEAR(sum / 5, 3.46, 0.005);  // as the paper's text says
}

TEST(PublishedAccuracy, RefusesFaultsWithTheirPlace) {
  const std::string header =
      "sequence,estimator,loop_closure,width,height,chosen_by,figure,value,unit,source\n";
  const auto refuse = [&](const std::string& row, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_accuracy("f.csv", header + row); }, parts);
  };
  EXPECT_EQ(parse_accuracy("f.csv", header + "a,levio,no,4,3,ate,ate,1,m,t\n").size(), 1u);
  refuse("a,levio,no,4,3,ate,ate,1,%,t\n", {"f.csv line 2", "expected m"});
  refuse("a,levio,no,4,3,ate,rmse,1,m,t\n", {"f.csv line 2", "'rmse'", "ate or relative"});
  refuse("a,levio,no,4,3,rmse,ate,1,m,t\n", {"f.csv line 2", "'rmse'", "ate or relative"});
  refuse("a,levoi,no,4,3,ate,ate,1,m,t\n", {"levoi"});
  refuse("a,levio,no,4,3,ate,ate,1,m\n", {"f.csv line 2"});
  refuse("a,b,maybe,1,1,,ate,1,m,us\n", {"f.csv line 2", "yes or no"});
  expect_input_error([] { parse_accuracy("f.csv", "a,b,c,d,e,f,g,h,i,j\n"); }, {"the title"});
}

TEST(Ablation, PutsThePapersValuesBesideItsSequencesOnly) {
  Ablation ablation;
  BatchPlan& plan = ablation.plan;
  plan.profiles = {"levio", "levio-no-imu"};
  plan.sizes = {{752, 480}, {160, 120}};
  plan.seeds = {1, 2, 3};
  for (const char* name : {"MH_01_easy", "MH_01_easy", "mine"})
    plan.sequences.push_back({name, "folder", "inputs", 100, 50, {}, "work"});
  const std::vector<Point> runs = ablation_runs(ablation);
  EXPECT_EQ(runs.size(), 2u * 2 * 3 * 3);
  std::vector<RunOutcome> outcomes;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    RunOutcome& o = outcomes.emplace_back();
    o.ate_m = static_cast<double>(i);
    o.relative_percent = 10;
    o.completion = 1;
    o.protocol = "protocol";
  }
  outcomes[2] = {};
  outcomes[2].failure = "the pose is no number";
  const std::vector<AblationRow> rows =
      ablation_rows(ablation, runs, outcomes, published_accuracy());
  ASSERT_EQ(rows.size(), 2u * 2 * 2 + 2 * 2);
  EXPECT_EQ(rows[0].sequence, "MH_01_easy");
  EXPECT_EQ(rows[0].ate.runs, 6u);
  EXPECT_EQ(rows[0].ate.failed, 1u);
  EXPECT_EQ(rows[0].ate.median, 3.5);  // of 0, 1, 3, 4, 5 and one that diverged
  EXPECT_FALSE(rows[0].ate.high);
  EXPECT_EQ(rows[0].paper_ate.value().value, 0.963);
  EXPECT_EQ(rows[0].paper_relative.value().value, 26.96);
  EXPECT_EQ(rows[1].paper_ate.value().value, 6.092);
  EXPECT_EQ(rows[2].size.width, 160);  // for which the paper has no values
  EXPECT_EQ(rows[2].paper_ate.value().value, 0.963);
  EXPECT_EQ(rows[2].paper_ate.value().size.width, 752);
  EXPECT_FALSE(rows[4].paper_ate);  // mine
  EXPECT_EQ(rows[8].sequence, "");
  EXPECT_EQ(rows[8].ate.median, (3.5 + rows[4].ate.median.value()) / 2);
  const Table table = ablation_table(ablation, rows);
  expect_parts(terminal_text(table, kAnyWidth), {"diverged", " 0.963 ", "752x480", "mean of them"});
  expect_parts(ablation_notes(ablation, rows, "- "), {"protocol"});
  EXPECT_EQ(rows_json(table).at(0).at("paper_ate_m"), 0.963);
  EXPECT_EQ(rows_json(table).size(), rows.size());

  plan.measure.length_m = 20;
  EXPECT_FALSE(ablation_rows(ablation, runs, outcomes, published_accuracy())[0].paper_relative);
}

TEST(Dimensions, AreThePapersFive) {
  std::vector<std::string_view> names;
  for (const Dimension& d : paper_dimensions()) {
    names.push_back(d.parameter->name);
    const double levio = d.parameter->get(vio::profile_named("levio", 1));
    EXPECT_LE(d.low, levio) << d.parameter->name;
    EXPECT_GE(d.high, levio) << d.parameter->name;
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{
                       "workload.window", "workload.keyframe_parallax",
                       "workload.reprojection_noise", "workload.imu_noise.gyro",
                       "workload.imu_noise.accel", "workload.gravity_updates"}));
}

TEST(Dimensions, PointsAreValidAndDoNotDependOnTheirNumber) {
  const std::vector<Dimension> dimensions = paper_dimensions();
  const auto few = sample_points(dimensions, 5, 1);
  const auto many = sample_points(dimensions, 200, 1);
  EXPECT_TRUE(many[0].empty());
  for (std::size_t i = 1; i < few.size(); ++i)
    for (std::size_t d = 0; d < dimensions.size(); ++d)
      EXPECT_EQ(few[i][d].value, many[i][d].value);
  EXPECT_NE(sample_points(dimensions, 2, 2)[1][1].value, few[1][1].value);
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    double least = dimensions[d].high;
    double greatest = dimensions[d].low;
    for (std::size_t i = 1; i < many.size(); ++i) {
      const double value = many[i][d].value;
      EXPECT_TRUE(vio::is_valid(*dimensions[d].parameter, value)) << value;
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
    EXPECT_GE(least, dimensions[d].low);
    EXPECT_LE(greatest, dimensions[d].high);
    EXPECT_LT(least, dimensions[d].low + 0.2 * (dimensions[d].high - dimensions[d].low));
    EXPECT_GT(greatest, dimensions[d].high - 0.2 * (dimensions[d].high - dimensions[d].low));
  }
}

/// A folder of 6 frames without features: fast, and good enough for messages and files.
class BatchCommands : public ::testing::Test {
 protected:
  std::vector<std::string> words(std::vector<std::string> further) {
    std::vector<std::string> all{"ablate",  "--data",    "flight=" + data_.root().string(),
                                 "--size",  "32x24",     "--relative",
                                 "1",       "--out",     path("out"),
                                 "--cache", path("runs")};
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

TEST_F(BatchCommands, RefuseBadInputBeforeAnyRun) {
  expect_refused(run_program(folder_.path(), {"ablate"}), {"--data is missing"});
  expect_refused(run_program(folder_.path(), {"ablate", "--data", "x"}), {"--out is missing"});
  expect_refusal({"--data", "/nonexistent"}, {"/nonexistent"});
  expect_refusal({"--data", data_.root().string()}, {"holds the same flight"});
  expect_refusal({"--profile", "levoi"}, {"levoi", "levio"});
  expect_refusal({"--seed", "1,1"}, {"--seed '1'", "twice"});
  expect_refusal({"--seed", "one"}, {"--seed 'one'"});
  expect_refusal({"--jobs", "0"}, {"--jobs '0'"});
  expect_refusal({"--align", "rigid"}, {"rigid", "se3"});
  expect_refusal({"-p", "cluster.workers=4"}, {"cluster.workers=4", "without a chip"});
  expect_refusal({"-p", "workload.windw=4"}, {"did you mean 'workload.window'?"});
  expect_refusal({"--sede", "1"}, {"did you mean '--seed'?"});
  expect_refusal({"--size", "64x48"}, {"64x48"});
  expect_refusal({"--vary", "workload.windo=4:8"}, {"did you mean 'workload.window'?"});
  expect_refusal({"--vary", "workload.window=8:4"}, {"lower value first"});
  expect_refusal({"--vary", "workload.window"}, {"NAME=LOW:HIGH, or paper"});
  expect_refusal({"--vary", "workload.window=1:4"}, {"'1'", "from 2 to 32"});
  expect_refusal({"--vary", "workload.gravity_updates=0:1"}, {"off or on"});
  expect_refusal({"--vary", "paper", "--vary", "workload.window=4:8"}, {"given twice"});
  expect_refusal({"--vary", "paper", "-p", "workload.window=6"},
                 {"workload.window=6", "is varied"});
  expect_refusal({"--vary", "paper", "--points", "0"}, {"--points '0'"});
}

TEST_F(BatchCommands, ReplaceNothingButResults) {
  fs::create_directory(folder_ / "out");
  outputs::write_file_atomically(folder_ / "out/thesis.tex", "mine");
  expect_refused(run_program(folder_.path(), words({"--force"})), {"something other than results"});
  EXPECT_TRUE(fs::exists(folder_ / "out/thesis.tex"));
}

/// Of finished runs in a cache.
std::size_t finished_runs(const fs::path& cache) {
  std::size_t count = 0;
  std::error_code error;  // there is nothing at first
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(cache, error)) {
    const std::string name = entry.path().filename().string();
    if (name.front() != '.' && name.ends_with(".json")) ++count;
  }
  return count;
}

/// Kills the program once some of its runs are finished, and starts it again.
void expect_resumes(const fs::path& folder, std::vector<std::string> words,
                    const std::vector<std::string>& files) {
  const ProgramResult undisturbed = run_program(folder, words);
  ASSERT_EQ(undisturbed.status, 0) << undisturbed.err;
  const auto expected = contents(folder / "out");
  for (const std::string& name : files) EXPECT_TRUE(expected.count(name)) << name;
  const std::size_t all = finished_runs(folder / "runs");
  fs::remove_all(folder / "out");
  fs::remove_all(folder / "runs");

  Program killed(folder, words);
  while (killed.running() && finished_runs(folder / "runs") == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  killed.send(SIGKILL);
  EXPECT_EQ(killed.wait().status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_GE(finished_runs(folder / "runs"), 1u);
  EXPECT_LT(finished_runs(folder / "runs"), all);

  const ProgramResult resumed = run_program(folder, words);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(resumed.out, undisturbed.out);
  EXPECT_EQ(contents(folder / "out"), expected);
  EXPECT_EQ(finished_runs(folder / "runs"), all);

  // Now everything is found again.
  words.emplace_back("--force");
  const ProgramResult again = run_program(folder, words);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out, undisturbed.out);
  EXPECT_NE(again.err.find(fmt::format("run {0}/{0}, {0} of them done before", all)),
            std::string::npos)
      << again.err;
}

TEST_F(BatchCommands, DrawnPointsResume) {
  expect_resumes(folder_.path(),
                 words({"--vary", "paper", "--points", "30", "--profile", "levio", "--seed", "1,2",
                        "--jobs", "1"}),
                 {"runs.csv", "rows.csv", "table.md", "manifest.json"});
  EXPECT_EQ(lines_of(base::read_text_file(folder_ / "out/runs.csv")), 1u + 30 * 2);
  EXPECT_EQ(lines_of(base::read_text_file(folder_ / "out/rows.csv")), 1u + 30);
  const ProgramResult shown = run_program(
      folder_.path(), words({"--vary", "paper", "--points", "30", "--profile", "levio", "--seed",
                             "1,2", "--force", "--report", (folder_ / "page.html").string()}));
  EXPECT_EQ(shown.status, 0) << shown.err;
  const std::string page = base::read_text_file(folder_ / "page.html");
  for (const char* part : {R"("axes":["relative_median_percent","ate_median_m"])",
                           R"("mark":"levio")", "levio has its least absolute error"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST_F(BatchCommands, ManifestsDoNotDependOnTheNumberOfJobs) {
  std::string one;
  for (const char* jobs : {"--jobs=1", "--jobs=2"}) {
    const ProgramResult result =
        run_program(folder_.path(), words({"--profile", "levio", "--seed", "1", jobs}));
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string manifest = base::read_text_file(folder_ / "out/manifest.json");
    if (one.empty()) one = manifest;
    EXPECT_EQ(manifest, one);
    fs::remove_all(folder_ / "out");
  }
  EXPECT_EQ(one.find("jobs"), std::string::npos);
}

TEST(AblateCommand, ResumesAfterAKillAndComparesProfiles) {
  const TempFolder folder;
  traces::write_synthetic_flight(folder / "flight", {.duration_s = 2, .texel_m = 0.01});
  const auto path = [&](const char* name) { return (folder / name).string(); };
  expect_resumes(folder.path(),
                 {"ablate", "--data", path("flight"), "--seed", "1,2", "--out", path("out"),
                  "--cache", path("runs"), "--relative", "0.5", "--jobs", "2"},
                 {"runs.csv", "rows.csv", "table.md", "manifest.json"});
  const Json rows = rows_json(read_csv("rows.csv", base::read_text_file(folder / "out/rows.csv")));
  ASSERT_EQ(rows.size(), 3u);
  for (const Json& row : rows) {
    EXPECT_EQ(row.at("sequence"), "flight");
    EXPECT_EQ(row.at("runs"), 2);
    EXPECT_FALSE(row.contains("paper_ate_m"));
    EXPECT_EQ(row.at("completion"), 1.0);
    EXPECT_LT(row.at("ate_least_m"), row.at("ate_greatest_m"));  // of two seeds
  }
  EXPECT_EQ(lines_of(base::read_text_file(folder / "out/runs.csv")), 7u);
  expect_parts(
      base::read_text_file(folder / "out/table.md"),
      {"| flight | 160x120 | levio-no-imu-no-epnp | 2 | 0 |", "- flight: SE3-aligned, 40 of 40"});
}

}  // namespace
}  // namespace leviosim::tools
