// The data of reports: verdicts, key figures, tables of a run folder, and the page around them.
#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "tests/tools/example_run.h"
#include "tests/traces/test_folder.h"
#include "tools/app/html_report/key_figures.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/report_option.h"
#include "tools/app/html_report/run_data.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/record/statistics.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

using testing::example_run;
using traces::testing::expect_input_error;

RunFolder reported(const RunResult& run, const std::string& name = "out") {
  Manifest manifest;
  manifest.command_line = {"run"};
  manifest.platform = "gap9";
  manifest.data = "flight";
  return run_folder(name, std::make_shared<const RunResult>(run), manifest, "");
}

Json json_of(const RunResult& run) { return run_json(reported(run)); }

/// The example with latencies below its period of 50 ms.
RunResult punctual_run() {
  RunResult run = example_run();
  for (FrameResult& frame : run.frames)
    frame.end_ns = std::min(frame.end_ns, frame.arrival_ns + 45'000'000);
  return run;
}

TEST(Verdict, HasAGradeAndThreeVerdictsWithReasons) {
  const Json run = json_of(example_run());  // one of five takes 60 ms
  EXPECT_EQ(run["verdict"]["grade"], "doubtful");
  ASSERT_EQ(run["verdict"]["list"].size(), 3u);
  EXPECT_EQ(run["verdict"]["list"][0]["word"], "fits on average");
  EXPECT_EQ(run["verdict"]["list"][2]["about"], "map");
  EXPECT_EQ(json_of(punctual_run())["verdict"]["grade"], "good");
}

TEST(Verdict, OfAFolderIsThatOfTheRunInMemory) {
  RunResult run = example_run();
  run.ate->translation.rmse = 1;
  run.ate->size_ratio = 1.4;
  run.ate->located_rmse_m = 0.9;
  const RunFigures in_memory = figures_of(run);
  const RunRecord read = parse_record("run.json", record_text(reported(run).record), Level::all);
  EXPECT_EQ(read.verdicts.text(), in_memory.verdicts.text());
  EXPECT_NE(read.verdicts.text().find("the scale is 1.40"), std::string::npos);
  ASSERT_EQ(read.statistics.size(), in_memory.statistics.size());
  for (std::size_t i = 0; i < read.statistics.size(); ++i)
    EXPECT_EQ(read.statistics[i].value, in_memory.statistics[i].value) << read.statistics[i].name;
}

TEST(Verdict, NamesTheStageThatTakesMostOfTheSlowestFrame) {
  RunResult run = example_run();
  run.frame_stages = {"feature extraction", "EPnP RANSAC"};
  run.frames[2].stage_cycles = {Cycles(1'000'000), Cycles(4'000'000)};
  const std::string why = json_of(run)["verdict"]["why"];
  EXPECT_NE(why.find("number 2"), std::string::npos) << why;
  EXPECT_NE(why.find("spends 40 ms in EPnP RANSAC, of 60 ms"), std::string::npos) << why;
}

TEST(Verdict, OfAMemoryThatIsTooSmallIsNo) {
  RunResult run = punctual_run();
  run.l1_size = Bytes(60'000);  // the example needs 64 000
  EXPECT_EQ(json_of(run)["verdict"]["grade"], "bad");
}

TEST(Verdict, OfANativeRunIsThatOfItsMap) {
  RunResult run = example_run();
  run.timed = false;
  const Json json = json_of(run);
  ASSERT_EQ(json["verdict"]["list"].size(), 1u);
  EXPECT_EQ(json["verdict"]["list"][0]["about"], "map");
  EXPECT_TRUE(json["tables"]["stages"].is_null());
}

TEST(KeyFigures, AnErrorNeverStandsWithoutItsProtocol) {
  const RunRecord run = reported(example_run()).record;
  const auto has_error = [](const std::vector<KeyFigure>& figures) {
    return std::any_of(figures.begin(), figures.end(),
                       [](const KeyFigure& f) { return f.unit == "m RMSE"; });
  };
  EXPECT_FALSE(has_error(key_figures(run, "")));
  const std::vector<KeyFigure> figures = key_figures(run, "aligned");
  ASSERT_TRUE(has_error(figures));
  EXPECT_EQ(figures.back().note, "aligned");
  EXPECT_EQ(figures.back().value, "0.176");
}

TEST(RunJson, HasATableForEveryFileAndNamesItsStages) {
  const Json run = json_of(example_run());
  EXPECT_EQ(run["tables"]["frames"]["latency_ns"].size(), 5u);
  EXPECT_EQ(run["tables"]["frames"]["t_s"][2], 0.1);
  EXPECT_EQ(run["stages"][1]["name"], "EPnP RANSAC");
  EXPECT_EQ(run["stages"][1]["key"], "epnp_ransac");
  EXPECT_EQ(run["stages"][2]["on_controller"], true);
  EXPECT_FALSE(run["tables"]["stages"].contains("f32_add_ops"));
}

TEST(RunJson, HasWordsForEverySourceOfAPose) {
  const Json sources = json_of(example_run())["pose_sources"];
  ASSERT_EQ(sources.size(), vio::kPoseSources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    EXPECT_EQ(sources[i]["name"], vio::kPoseSources[i].name);
    EXPECT_FALSE(sources[i]["words"].get<std::string>().empty());
  }
}

TEST(KeyFigures, ShowWhatRowsCompute) {
  const RunRecord run = reported(example_run()).record;
  for (const FigureRow& row : figure_rows()) {
    if (row.of == nullptr) continue;
    const std::vector<KeyFigure> figures = key_figures(run, "");
    EXPECT_TRUE(std::any_of(figures.begin(), figures.end(), [&](const KeyFigure& f) {
      return f.note == row.meaning && f.unit == row.title_unit;
    })) << row.title;
  }
}

TEST(RunJson, RefusesATableThatLacksAColumn) {
  RunFolder run = reported(example_run());
  run.tables.at(kMemoryFile) = read_csv("", "memory,owner\nL1,x\n");
  expect_input_error([&] { run_json(run); }, {"out/memory.csv", "what"});
}

TEST(RunJson, OfAFolderIsThatOfTheRunInMemory) {
  const traces::testing::TempFolder folder;
  const RunFolder run = reported(example_run(), (folder / "out").string());
  {
    outputs::OutputFolder out({.option = "--out", .path = run.record.name});
    write_run_folder(out, run);
    EXPECT_FALSE(out.commit());
  }
  EXPECT_EQ(run_json(read_run_folder(run.record.name, true)), run_json(run));
}

TEST(RunJson, IsTheSameOnAnyHost) {
  RunResult slow = example_run();
  slow.host_seconds = 99;
  EXPECT_EQ(json_of(slow), json_of(example_run()));
}

TEST(Page, NoTextOfTheDataEndsItsElement) {
  const std::string name = "</script><script>alert(1)</script><!--";
  const RunFolder run = reported(example_run(), name);
  const std::string page = html_page(runs_report({run}, {}, nullptr));
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script>\\u003cscript>alert(1)"), std::string::npos);
}

TEST(Page, TitlesAreText) {
  const std::string page = html_page(report_json("<b>&\"'", Json::array()));
  EXPECT_NE(page.find("<title>&lt;b&gt;&amp;&quot;&#39; "), std::string::npos);
}

TEST(Page, HoldsTheLibraryAndItsLicenceAndLoadsNothing) {
  const std::string page = html_page(report_json("x", Json::array()));
  EXPECT_NE(page.find("Chart.js v3.9.1"), std::string::npos);
  EXPECT_NE(page.find("Permission is hereby granted"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* loading : {"src=\"", "url(", "@import", "<link rel=\"stylesheet\""})
    EXPECT_EQ(page.find(loading), std::string::npos) << loading;
  EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(StudyPage, LeavesOutWhatNoPointHasAndScales) {
  Table points({{.title = "clock", .key = "clock", .unit = "MHz", .is_setup = true},
                {.title = "missed", .key = "missed", .unit = "%", .scale = 100},
                {.title = "error", .key = "ate", .unit = "m"}});
  points.add({100.0, 0.25, Cell()});
  points.add({200.0, 0.5, Cell()});
  const Json data = study_report({.title = "x",
                                  .summary = "",
                                  .points = points,
                                  .x = "power",
                                  .y = "missed",
                                  .colour = "power"});
  const Json& study = data["study"];
  EXPECT_EQ(study["columns"].size(), 2u);
  EXPECT_EQ(study["table"]["missed"], Json::parse("[25.0,50.0]"));
  EXPECT_EQ(study["axes"], Json::parse(R"(["clock","missed"])"));
  EXPECT_EQ(study["colour"], "");
}

TEST(StudyPage, SaysThatAPathDivergedInPlaceOfANumber) {
  Table points({{.title = "error", .key = "ate", .unit = "m"}});
  points.add({2.54e23});
  points.add({0.5});
  const Json data = study_report(
      {.title = "x", .summary = "", .points = points, .x = "ate", .y = "ate", .colour = ""});
  EXPECT_EQ(data["study"]["table"]["ate"], Json::parse(R"(["diverged",0.5])"));
}

}  // namespace
}  // namespace leviosim::tools
