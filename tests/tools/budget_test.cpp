// Files of budgets, limits on a run made by hand, and the reports of a check.
#include "tools/app/budget/budget.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "tests/tools/example_run.h"
#include "tests/tools/junit_schema.h"
#include "tests/traces/test_folder.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/check_for_ci.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/budget/first_budget.h"
#include "tools/app/budget/gate.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

using testing::example_run;
using testing::junit_fault;
using traces::testing::expect_input_error;

RunRecord record_of(const RunResult& run = example_run()) {
  Manifest manifest;
  manifest.platform = "gap9";
  std::vector<StageParts> parts{
      {"feature extraction",
       false,
       2e6,
       {{"detect", "issue", "int_alu", 1.5e6, 1e6}, {"", "fpu", "", 5e5, 0}}}};
  RunRecord record = make_record("run", manifest, run);
  record.cycles = parts;
  return record;
}

/// Latencies of 10, 20, 60, 30, 40 ms; 64 kB of L1; ATE 0.176 m; 1000 kcycles of extraction.
Budget budget(const std::string& limits) {
  return parse_budget("b.yaml", "budgets:\n  - platform: gap9\n    limits:\n" + limits);
}
Budget one(const std::string& limit) { return budget("      - \"" + limit + "\"\n"); }
Budget of_stage(const std::string& stage, const std::string& limit) {
  return budget("      - stage: \"" + stage + "\"\n        limit: " + limit + "\n");
}

bool met(const Budget& b, const RunRecord* baseline = nullptr) {
  return check_budget(record_of(), b, baseline).missed() == 0;
}

TEST(Budget, LimitsHoldAtTheirValueAndNotBeyond) {
  struct Row {
    const char* limit;
    bool met;
  };
  for (const Row& row :
       {Row{"frame latency p50 <= 30 ms", true}, Row{"frame latency p50 <= 29.99 ms", false},
        Row{"frame latency worst <= 60000 us", true}, Row{"frame latency mean >= 0.032 s", true},
        Row{"L1 peak <= 64 kB", true}, Row{"L1 peak <= 62 KiB", false},
        Row{"L2 peak <= 794.5 kB", true}, Row{"ATE <= 0.176 m", true}, Row{"ATE <= 17.5 cm", false},
        Row{"missed <= 20 %", true}, Row{"missed <= 0.19", false}, Row{"completion >= 100 %", true},
        Row{"stages.feature_extraction.speedup >= 4", true}, Row{"stages.*.calls <= 3", true},
        Row{"stages.*.calls <= 2", false}})
    EXPECT_EQ(met(one(row.limit)), row.met) << row.limit;
}

TEST(Budget, LimitsOfStagesTakePatterns) {
  EXPECT_TRUE(met(of_stage("feature extraction", "cycles <= 1000 kcycles")));
  EXPECT_TRUE(met(of_stage("feature_extraction", "cycles <= 1 Mcycles")));
  EXPECT_FALSE(met(of_stage("feat*", "cycles <= 999999 cycles")));
  EXPECT_FALSE(met(of_stage("*", "cycles on one core <= 3 Mcycles")));
}

TEST(Budget, AStageWithoutCallsIsTheSameByNameKeyAndPattern) {
  const RunRecord run = record_of();
  for (const char* stage : {"EPnP RANSAC", "epnp_ransac", "*RANSAC", "*"}) {
    const Budget absolute = of_stage(stage, "cycles <= 1 Mcycles");
    const CheckResult result = check_budget(run, absolute, nullptr);
    ASSERT_EQ(result.missed(), 1u) << stage;
    for (const Finding& finding : result.findings)
      if (finding.fails()) {
        EXPECT_EQ(finding.title(), "EPnP RANSAC: cycles <= 1 Mcycles");
        EXPECT_EQ(finding.excess(), "the run has no such value");
      }
    // Nor did the baseline call it.
    const Budget relative = of_stage(stage, "cycles <= +1 %");
    EXPECT_EQ(check_budget(run, relative, &run).missed(), 0u) << stage;
  }
}

TEST(Budget, RelativeLimitsAreHeldAgainstTheBaseline) {
  RunResult before = example_run();
  before.stages[0].parallel = Cycles(1'900'000);  // the run takes 5.26 % more
  const RunRecord baseline = record_of(before);
  EXPECT_TRUE(met(of_stage("feature extraction", "cycles <= +5.3 %"), &baseline));
  EXPECT_FALSE(met(of_stage("feature extraction", "cycles <= +5.2 %"), &baseline));
  EXPECT_TRUE(met(of_stage("feature extraction", "cycles <= +50 kcycles"), &baseline));
  EXPECT_FALSE(met(of_stage("feature extraction", "cycles <= +49 kcycles"), &baseline));
  EXPECT_FALSE(met(of_stage("feature extraction", "cycles <= -1 %"), &baseline));
  EXPECT_TRUE(met(one("ATE <= +0 %"), &baseline));
}

TEST(Budget, OnlySectionsOfThePlatformAndProfileCount) {
  const std::string text =
      "budgets:\n  - platform: gap8\n    limits: [L1 peak <= 1 kB]\n"
      "  - platform: gap*\n    profile: lev*\n    limits: [L1 peak <= 110 kB]\n";
  EXPECT_TRUE(met(parse_budget("b.yaml", text)));
  expect_input_error(
      [] {
        met(parse_budget("b.yaml", "budgets:\n  - profile: next\n    limits: [L1 peak <= 1 kB]\n"));
      },
      {"b.yaml", "no budget for levio on gap9", "next on *"});
}

TEST(Budget, RefusesBadFiles) {
  struct Row {
    std::string text;
    std::vector<std::string> parts;
  };
  const std::string head = "budgets:\n  - limits:\n";
  for (const Row& row : {
           Row{"", {"b.yaml"}},
           Row{"budget: []\n", {"b.yaml:1", "budget", "expected budgets"}},
           Row{"budgets: 3\n", {"b.yaml:1", "expected a list"}},
           Row{"budgets:\n  - platform: gap9\n", {"b.yaml:2", "limits"}},
           Row{"budgets:\n  - platfrom: gap9\n", {"b.yaml:2", "did you mean 'platform'"}},
           Row{head + "      - limit: L1 peak <= 1 kB\n        resaon: x\n",
               {"b.yaml:4", "did you mean 'reason'"}},
           Row{head + "      - reason: x\n", {"b.yaml:3", "has no 'limit'"}},
           Row{head + "      - L1 peak < 110 kB\n", {"b.yaml:3", "neither <= nor >="}},
           Row{head + "      - L1 peak <= kB\n", {"b.yaml:3", "NUMBER UNIT"}},
           Row{head + "      - L1 peak <= nan kB\n", {"b.yaml:3", "NUMBER UNIT"}},
           Row{head + "      - L1 peak <= 110\n", {"b.yaml:3", "has no unit", "kB"}},
           Row{head + "      - L1 peak <= 110 ms\n", {"b.yaml:3", "'ms'", "KiB"}},
           Row{head + "      - L1 peek <= 110 kB\n", {"b.yaml:3", "did you mean 'L1 peak'"}},
           Row{head + "      - frame latency p98 <= 1 ms\n", {"b.yaml:3", "frame latency p9"}},
           Row{head + "      - stage: x\n        limit: cycle <= 1 cycles\n",
               {"b.yaml:3", "did you mean 'cycles'"}},
       })
    try {
      parse_budget("b.yaml", row.text);
      ADD_FAILURE() << "accepted: " << row.text;
    } catch (const InputError& error) {
      for (const std::string& part : row.parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
            << "'" << part << "' is not in: " << error.what();
    }
}

TEST(Budget, RefusesWhatARunCannotSay) {
  expect_input_error([] { met(one("stages.feature_extraction.spedup >= 4")); },
                     {"b.yaml:4", "did you mean 'stages.feature_extraction.speedup'"});
  expect_input_error([] { met(of_stage("feature extraction", "cycles <= 3 %")); },
                     {"per cent of what", "<= +3 %"});
  expect_input_error([] { met(of_stage("feature extractoin", "cycles <= 1 cycles")); },
                     {"b.yaml:4", "did you mean 'feature extraction'"});
  expect_input_error([] { met(one("ATE <= +1 %")); }, {"b.yaml:4", "--baseline"});
  expect_input_error([] { met(one("stages.feature_extraction.calls <= 2 ms")); },
                     {"b.yaml:4", "'ms'"});
}

TEST(Budget, WhatARunDoesNotHaveIsNotMet) {
  RunResult run = example_run();
  run.stages[0].calls = 0;
  const CheckResult result =
      check_budget(record_of(run), of_stage("feature extraction", "cycles <= 1 Mcycles"), nullptr);
  ASSERT_EQ(result.missed(), 1u);
  EXPECT_EQ(result.findings[0].excess(), "the run has no such value");
}

/// What a check may find by them: also by stages and statistics that a pattern stands for.
TEST(Budget, AcceptsMissesOfItsLimitsOnly) {
  const auto parse = [](const std::string& title) {
    return parse_budget(
        "b.yaml",
        "budgets:\n  - limits:\n      - { stage: \"*ransac\", limit: cycles <= +3 % }\n"
        "      - L1 peak <= 1 kB\n      - stages.*.calls <= 3\n"
        "accepted:\n  - { limit: \"" +
            title + "\", reason: r, until: 2099-12-31 }\n");
  };
  for (const char* title : {"EPnP RANSAC: cycles <= +3 %", "L1 peak <= 1 kB",
                            "stages.epnp_ransac.calls <= 3", "time verdict <= fits on average"})
    EXPECT_EQ(parse(title).accepted.size(), 1u) << title;
  for (const char* title :
       {"EPnP: cycles <= +3 %", "EPnP RANSAC: cycles <= +4 %", "L1 peak <= 2 kB", "cycles <= +3 %"})
    expect_input_error([&] { parse(title); }, {"b.yaml:7", title});
}

TEST(Budget, SaysByHowMuchWhereAndWhy) {
  RunRecord before = record_of();
  before.cycles[0].cycles -= 3e5;
  before.cycles[0].parts[0].cycles -= 3e5;
  for (Statistic& s : before.statistics)
    if (s.name == "stages.feature_extraction.cycles.parallel.mean") *s.value *= 0.85;
  const Budget b = parse_budget("b.yaml",
                                "budgets:\n  - owner: vision\n    limits:\n"
                                "      - stage: feature*\n        limit: cycles <= +3 %\n"
                                "        reason: a <frame> & more\n");
  const CheckResult result = check_budget(record_of(), b, &before);
  ASSERT_EQ(result.missed(), 1u);
  const Finding& f = result.findings[0];
  EXPECT_EQ(f.title(), "feature extraction: cycles <= +3 %");
  EXPECT_EQ(
      f.excess(),
      "1000.0 kcycles, 14.22 % above 875.5 kcycles; +17.65 % of the baseline's 850.0 kcycles");
  EXPECT_EQ(f.where, "feature extraction, detect");
  ASSERT_FALSE(f.why.empty());
  EXPECT_EQ(f.why[0], "issue: int_alu +17.65 %");
  const std::vector<std::string> parts = check_printout(result, {}).parts;
  const std::string text = parts.at(0) + parts.at(1);
  for (const char* part :
       {"1 not met", "b.yaml:4", "detect", "int_alu", "a <frame> & more", "owner: vision"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  EXPECT_EQ(check_json(result).at("findings").at(0).at("where"), "feature extraction, detect");
}

TEST(Budget, MemoryThatIsTooFullNamesStageAndBlock) {
  const CheckResult result = check_budget(record_of(), one("L1 peak <= 60 kB"), nullptr);
  ASSERT_EQ(result.missed(), 1u);
  EXPECT_EQ(result.findings[0].where, "feature extraction, block scratch");
  EXPECT_EQ(result.findings[0].why[0], "scratch is 20.0 kB");
}

TEST(Budget, JUnitIsWhatServersRead) {
  const Budget b = parse_budget("b \"<&>.yaml",
                                "budgets:\n  - name: \"a <b> & \\\"c\\\"\"\n    limits:\n"
                                "      - L1 peak <= 1 kB\n      - ATE <= 1 m\n"
                                "  - limits:\n      - missed <= 50 %\n");
  const std::string xml = junit_xml(check_budget(record_of(), b, nullptr));
  EXPECT_EQ(junit_fault(xml), "") << xml;
  EXPECT_NE(xml.find("tests=\"3\" failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(junit_fault("<testsuites><testsuite/></testsuites>"), "");
  EXPECT_NE(junit_fault("<testsuite>"), "");
}

TEST(Budget, AnnotationsAreOneLineEachAndEscaped) {
  Budget b = one("missed <= 1 %");
  b.sections[0].limits[0].reason = "first\nsecond";
  const std::string text = github_annotations(check_budget(record_of(), b, nullptr));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_EQ(text.rfind("::error file=b.yaml,line=4,title=missed <= 1 %25::", 0), 0u) << text;
  EXPECT_EQ(text.find("%\n"), std::string::npos);
}

TEST(Budget, GitLabReadsAListOfFindings) {
  const Json list =
      Json::parse(gitlab_report(check_budget(record_of(), one("ATE <= 1 cm"), nullptr)));
  ASSERT_EQ(list.size(), 1u);
  for (const char* key : {"description", "check_name", "fingerprint", "severity", "location"})
    EXPECT_TRUE(list[0].contains(key)) << key;
  EXPECT_EQ(list[0]["location"]["lines"]["begin"], 4);
  EXPECT_EQ(
      Json::parse(gitlab_report(check_budget(record_of(), one("ATE <= 1 m"), nullptr))).size(), 0u);
}

TEST(Budget, AFirstBudgetIsMetAndTight) {
  const RunRecord run = record_of();
  EXPECT_EQ(check_budget(run, parse_budget("first.yaml", first_budget(run, 0)), nullptr).missed(),
            0u);
  RunResult more = example_run();
  more.stages[0].parallel = Cycles(2'200'000);
  EXPECT_EQ(check_budget(record_of(more), parse_budget("first.yaml", first_budget(run, 5)), nullptr)
                .missed(),
            1u);
  EXPECT_EQ(parse_share("--margin", "5%"), 5);
  for (const char* bad : {"5", "", "-1 %", "x", "5 ms"})
    expect_input_error([&] { parse_share("--margin", bad); }, {"--margin"});
}

TEST(Baseline, IsReadBackAndStandsForItsRun) {
  const RunRecord run = record_of();
  const std::string text = record_text(reduced(run, Level::kept));
  EXPECT_LT(text.size(), 10'000u);
  const RunRecord read = parse_record("base.json", text, Level::kept);
  EXPECT_EQ(read.facts, run.facts);
  EXPECT_EQ(read.value("frame.latency.p99"), run.value("frame.latency.p99"));
  EXPECT_TRUE(met(of_stage("*", "cycles <= +0 %"), &read));
  expect_input_error([&] { met(one("stages.*.speedup >= -1 %"), &read); }, {"budget record"});
  const Budget b = one("stages.*.speedup >= -1 %");
  const RunRecord with = parse_record(
      "base.json", record_text(reduced(run, Level::kept, figures_in(b, run))), Level::kept);
  EXPECT_TRUE(met(b, &with));
}

TEST(Baseline, RefusesWhatIsNone) {
  const std::string text = record_text(reduced(record_of(), Level::kept));
  for (const std::string& bad :
       {std::string(), std::string("{}"), std::string("[]"), text.substr(0, text.size() / 2),
        std::string("{\"format\": \"leviosim run\", \"version\": 2}")})
    expect_input_error([&] { parse_record("base.json", bad, Level::kept); }, {"base.json"});
}

/// Bytes changed, removed and doubled at random: every text is read or refused with its name.
TEST(Baseline, NoTextIsTooBroken) {
  std::mt19937 random(5);
  const RunRecord run = record_of();
  struct Reader {
    std::string text;
    std::function<void(const std::string&)> read;
  };
  const Reader readers[] = {
      {"budgets:\n  - platform: gap9\n    owner: x\n    limits:\n      - L1 peak <= 110 kB\n"
       "      - stage: \"feat*\"\n        limit: cycles <= +3 %\n",
       [&](const std::string& text) { check_budget(run, parse_budget("f", text), &run); }},
      {record_text(reduced(run, Level::kept)), [&](const std::string& text) {
         const RunRecord baseline = parse_record("f", text, Level::kept);
         check_budget(run, of_stage("*", "cycles <= -1 %"), &baseline);
       }}};
  for (const Reader& reader : readers)
    for (int round = 0; round < 400; ++round) {
      std::string text = reader.text;
      for (int change = 0; change < 3 && !text.empty(); ++change) {
        const std::size_t at = random() % text.size();
        switch (random() % 3) {
          case 0:
            text[at] = static_cast<char>(random());
            break;
          case 1:
            text.erase(at, random() % 40);
            break;
          default:
            text.insert(at, text.substr(random() % text.size(), random() % 40));
        }
      }
      try {
        reader.read(text);
      } catch (const InputError& error) {
        EXPECT_NE(error.what(), std::string());
      }
    }
}

TEST(BudgetShares, AreShownAsTheirLimitIs) {
  Limit limit;
  limit.bound = {.at_most = true, .relative = false, .number = 3.5, .unit = "%"};
  Finding finding{.limit = &limit,
                  .section = nullptr,
                  .statistic = "frame.missed_share",
                  .stage = "",
                  .unit = "1",
                  .value = 0.1033,
                  .bound = 0.035,
                  .baseline = {},
                  .where = "",
                  .why = {}};
  EXPECT_EQ(finding.excess(), "10.33 %, 6.83 percentage points above 3.50 %");
  limit.bound.unit = "";
  EXPECT_EQ(finding.excess(), "0.1033, 6.83 percentage points above 0.0350");
}

TEST(Budget, HoldsVerdictsByTheirWords) {
  EXPECT_TRUE(check_budget(record_of(), one("time verdict <= fits on average"), nullptr).missed() ==
              0);
  const Budget strict = one("time verdict <= fits");
  const CheckResult result = check_budget(record_of(), strict, nullptr);
  ASSERT_EQ(result.missed(), 1u);  // one of five frames is late
  EXPECT_NE(result.findings[0].excess().find("fits on average"), std::string::npos)
      << result.findings[0].excess();
  EXPECT_THROW(one("time verdict <= lost"), InputError);
  expect_input_error(
      [] { one("time verdict <= fits on averge"); },
      {"b.yaml:4", "fits, fits on average, too slow", "did you mean 'fits on average'"});
  EXPECT_THROW(one("L1 peak <= lost"), InputError);
}

TEST(Budget, NoVerdictMayBeTheWorstUnlessALimitAllowsIt) {
  RunResult run = example_run();
  run.ate->translation.rmse = 2.04;  // of 5.4 m
  const Budget silent = one("L1 peak <= 64 kB");
  const CheckResult result = check_budget(record_of(run), silent, nullptr);
  ASSERT_EQ(result.missed(), 1u);
  EXPECT_EQ(result.findings.back().title(), "map verdict <= unreliable");
  EXPECT_EQ(check_budget(record_of(run), one("map verdict <= lost"), nullptr).missed(), 0u);
  const std::string first = first_budget(record_of(run), 0);
  EXPECT_NE(first.find("map verdict <= lost"), std::string::npos) << first;
  EXPECT_EQ(check_budget(record_of(run), parse_budget("first.yaml", first), nullptr).missed(), 0u);
}

}  // namespace
}  // namespace leviosim::tools
