// Published systems beside predictions, and published errors beside an ablation's.
#include <gtest/gtest.h>

#include <algorithm>

#include "platform_models/loader/loader.h"
#include "tests/traces/test_folder.h"
#include "tools/app/study/ablate/ablation.h"
#include "tools/app/study/ablate/ablation_table.h"
#include "tools/app/study/ablate/published_accuracy.h"
#include "tools/app/study/systems/predictions.h"
#include "tools/app/study/systems/published_systems.h"
#include "tools/app/study/systems/systems_report.h"
#include "tools/app/table/table_files.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

const std::string kTitles =
    "system,year,class,chip,frames_per_s,power_mw,bound,workload,platform,set,absent,source\n";

TEST(PublishedSystems, EnergyOfAFrameIsPowerOverRate) {
  const auto systems =
      parse_systems("s.csv", kTitles + "A,2019,VIO,ASIC,20,2,,,,,an ASIC,us\n" +
                                 "B,2021,VIO,board,,,,,,,big cores,us\n" +
                                 "C,2022,flow,GAP8,500,25,at most,flow levio,gap8,a=1 b=2,,us\n");
  ASSERT_EQ(systems.size(), 3u);
  EXPECT_DOUBLE_EQ(*systems[0].frame_mj(), 0.1);
  EXPECT_FALSE(systems[1].frame_mj());
  EXPECT_TRUE(systems[2].is_bound);
  EXPECT_EQ(systems[2].overrides, (std::vector<std::string>{"a=1", "b=2"}));
  EXPECT_EQ(systems[2].workloads, (std::vector<std::string>{"flow", "levio"}));
  EXPECT_EQ(systems[0].absent, "an ASIC");
}

TEST(PublishedSystems, FaultsAreNamed) {
  const auto refused = [](const std::string& row, std::initializer_list<std::string> parts) {
    expect_input_error([&] { parse_systems("s.csv", kTitles + row); }, parts);
  };
  refused("A,2019,VIO,ASIC,-1,2,,,,,an ASIC,us\n", {"s.csv", "above 0"});
  refused("A,2019,VIO,ASIC,20,2,below,,,,an ASIC,us\n", {"'at most'"});
  refused("A,2019,VIO,ASIC,20,2,,levio,,,,us\n", {"a workload and a platform"});
  refused("A,2019,VIO,ASIC,20,2,,,,,an ASIC,\n", {"no source"});
  refused("A,2019,VIO,ASIC,20,2,,,,,,us\n", {"why there is none"});
  expect_input_error([] { parse_systems("s.csv", "a,b,c,d,e,f,g,h,i,j,k,l\n"); }, {"the title"});
}

/// What is modelled can be: its platform takes the overrides, and its workload is known.
TEST(PublishedSystems, ThoseOfTheProgramCanBeModelled) {
  const auto systems = published_systems();
  EXPECT_EQ(systems.size(), 10u);
  const auto modelled = std::count_if(systems.begin(), systems.end(), [](const PublishedSystem& s) {
    if (s.workloads.empty()) return false;
    EXPECT_NO_THROW(platform::resolve_platform(s.platform, s.overrides)) << s.name;
    for (const std::string& workload : s.workloads) {
      if (workload != kFlowWorkload) {
        EXPECT_NO_THROW(vio::profile_named(workload, 1));
      }
    }
    return true;
  });
  EXPECT_EQ(modelled, 5);
}

std::vector<SystemRow> example_systems() {
  std::vector<SystemRow> rows;
  for (const PublishedSystem& system : published_systems()) {
    if (system.workloads.empty()) rows.push_back({system});
    for (const std::string& workload : system.workloads) rows.push_back({system, workload});
  }
  Prediction here;
  here.frames_per_s = 20;
  here.most_frames_per_s = 29.9;
  here.power = sim::Estimate<Watts>{Watts(0.0302)};
  here.frame = sim::Estimate<Joules>{Joules(0.00151)};
  here.power->down[0] = here.power->up[0] = Watts(0.01);
  here.memory = "7 kB short of L1 at 'x'";
  here.fits = false;
  rows[3].here = here;
  return rows;
}

TEST(SystemsReport, PredictionsStandBesideTheirSystems) {
  const std::string table = systems_table(example_systems());
  for (const char* part :
       {"Navion, 2019", "   0.1  an ASIC", "< 0.4", "levio on gap9", "30.2 (20.2–40.2)",
        "1.51 (1.51–1.51)", "29.9", "levio on gap9 as though it fitted: 7 kB", "Jetson Xavier NX",
        "BotVIO: Wei et al. 2025"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in:\n" << table;
  const std::string csv = csv_text(systems_rows(example_systems()));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 5 + 3 + 3 + 2);
  EXPECT_NE(csv.find(",levio on gap9,20,29.9,30.2"), std::string::npos) << csv;
}

TEST(SystemsReport, ThePageHasAPointForEachRateWithAPower) {
  const Json table = study_report(systems_page(example_systems())).at("study").at("table");
  const auto spot = [&](const char* system, const char* by) {
    for (std::size_t i = 0; i < table.at("system").size(); ++i)
      if (table.at("system")[i] == system && table.at("by")[i] == by) return static_cast<int>(i);
    return -1;
  };
  for (const char* system : {"Navion", "Gu et al."})
    EXPECT_GE(spot(system, "published"), 0) << system;
  EXPECT_GE(spot("LEVIO", "published, at most"), 0);
  const int here = spot("LEVIO", "predicted here");
  ASSERT_GE(here, 0);
  EXPECT_NEAR(table.at("power")[here].get<double>(), 30.2, 1e-9);
  EXPECT_NEAR(table.at("low")[here].get<double>(), 20.2, 1e-9);
  EXPECT_NEAR(table.at("energy")[here].get<double>(), 1.51, 1e-9);
  EXPECT_EQ(spot("Bahnam et al.", "published"), -1);
  EXPECT_TRUE(study_report(systems_page({})).at("study").at("table").empty());
}

/// Of two sequences with two seeds, of which one run of the second failed.
TEST(Ablation, TheMeanCountsRunsAndFailures) {
  Ablation ablation;
  BatchPlan& plan = ablation.plan;
  plan.sequences.resize(2);
  plan.sequences[0].name = "a";
  plan.sequences[1].name = "b";
  plan.sizes = {{160, 120}};
  plan.profiles = {"next"};
  plan.seeds = {1, 2};
  std::vector<Point> runs(4);
  runs[2].row = runs[3].row = 1;
  std::vector<RunOutcome> outcomes(4);
  outcomes[0].ate_m = 0.1;
  outcomes[1].ate_m = 0.3;
  outcomes[2].ate_m = 0.6;
  outcomes[3].failure = "lost";
  const std::vector<AblationRow> rows = ablation_rows(ablation, runs, outcomes, {});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].ate.failed, 0u);
  EXPECT_EQ(rows[1].ate.failed, 1u);
  EXPECT_EQ(rows[2].sequence, "");
  EXPECT_EQ(rows[2].ate.runs, 4u);
  EXPECT_EQ(rows[2].ate.failed, 1u);
}

TEST(AccuracyComparison, StandsBesideTheAblationOfTheSameSequences) {
  Ablation ablation;
  BatchPlan& plan = ablation.plan;
  plan.sequences.resize(2);
  plan.sequences[0].name = "MH_01_easy";
  plan.sequences[1].name = "mine";
  AblationRow row;
  row.sequence = "MH_01_easy";
  row.profile = "next";
  row.size = {160, 120};
  row.ate = spread_of({0.031, 0.5, 0.1});
  const std::string table = accuracy_comparison(ablation, {row}, published_accuracy());
  for (const char* part : {"next, here", "160x120", "0.10", "VINS-Mono", "0.14", "0.20",
                           "ORB-SLAM3", "LEVIO", "0.96", "1.82"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in:\n" << table;
  EXPECT_EQ(table.find("mine"), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 2 + 1 + 2 + 6 + 1);
  plan.sequences.erase(plan.sequences.begin());
  EXPECT_EQ(accuracy_comparison(ablation, {row}, published_accuracy()), "");
}

}  // namespace
}  // namespace leviosim::tools
