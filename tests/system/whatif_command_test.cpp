// What if, as users ask: variants of the chip, chips of their own, other numbers of cores, advice.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "tests/support/program_suite.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

using testing::expect_refused;
using testing::ProgramResult;

class WhatIfCommand : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("whatif");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 3.2, .texel_m = 0.02});
    expect_done({"run", "--data", path("flight"), "--out", path("run"), "--record", "--quiet"});
  }

  static ProgramResult what_if(std::vector<std::string> words) {
    words.insert(words.begin(), {"whatif", path("run")});
    words.emplace_back("--quiet");
    return program(words);
  }
  /// The rows of --json.
  static Json rows(std::vector<std::string> words, int status = 0) {
    words.emplace_back("--json");
    const ProgramResult result = what_if(std::move(words));
    EXPECT_EQ(result.status, status) << result.err;
    return Json::parse(result.out).at("rows");
  }
  static double mean_ms(const Json& row) { return row.at("frame_mean_ms").get<double>(); }
};

TEST_F(WhatIfCommand, TriesSeveralValuesInOneCommand) {
  const Json table = rows({"cluster.fpu.units=1,8"});
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table[1].at("variant"), "cluster.fpu.units=1");
  EXPECT_GT(mean_ms(table[1]), mean_ms(table[0]));
  EXPECT_LE(mean_ms(table[2]), mean_ms(table[0]));
  EXPECT_GT(table[2].at("area_mm2").get<double>(), table[0].at("area_mm2").get<double>());
  EXPECT_NE(table[1].at("why").get<std::string>().find("waiting for a shared FPU +"),
            std::string::npos)
      << table[1];
  EXPECT_EQ(table[0].at("frames"), 64);
}

/// Times have bands, and every row all three verdicts.
TEST_F(WhatIfCommand, RowsHaveBandsAndVerdicts) {
  const Json table = rows({"cluster.clock=100MHz,controller.clock=100MHz"});
  for (const Json& row : table) {
    const double p99 = row.at("frame_p99_ms").get<double>();
    EXPECT_LT(row.at("frame_p99_ms_low").get<double>(), 0.97 * p99) << row;
    EXPECT_GT(row.at("frame_p99_ms_high").get<double>(), 1.03 * p99) << row;
    EXPECT_LT(row.at("frame_p99_ms_high").get<double>(), 1.5 * p99) << row;
    EXPECT_EQ(row.at("memory"), "fits");
    EXPECT_EQ(row.at("map"), table[0].at("map"));
  }
  EXPECT_EQ(table[1].at("time"), "too slow");
  EXPECT_EQ(table[1].at("verdict").get<std::string>().rfind("too slow", 0), 0u) << table[1];
  EXPECT_NE(table[0].at("time"), "too slow");
}

TEST_F(WhatIfCommand, TimesTheRunAsItIsLikeTheRun) {
  const Json frames = rows({"cluster.fpu.units=4"});
  EXPECT_EQ(mean_ms(frames[0]), mean_ms(frames[1])) << "4 are those of gap9";
  EXPECT_EQ(frames[1].at("why"), "no frame waits for it");
}

TEST_F(WhatIfCommand, TakesAChipOfThreeLinesAndOneInline) {
  std::ofstream(path("mine.yaml")) << "extends: gap9\ncluster:\n  fpu: { units: 1 }\n";
  const Json table = rows({path("mine.yaml"), "gap9:cluster.fpu.units=1", "cluster.fpu.units=1"});
  ASSERT_EQ(table.size(), 4u);
  EXPECT_EQ(mean_ms(table[1]), mean_ms(table[2]));
  EXPECT_EQ(mean_ms(table[1]), mean_ms(table[3]));
}

/// What a number of cores needs besides is raised with it, unless it was given.
TEST_F(WhatIfCommand, OtherNumbersOfCoresRaiseWhatTheyNeed) {
  const Json table = rows({"cluster.workers=16", "cluster.workers=16,cluster.max_workers=12",
                           "gap9:cluster.workers=16", "cluster.workers=12", "cluster.workers=4"},
                          1);
  ASSERT_EQ(table.size(), 6u);
  const std::string failure = table[2].at("failure");
  EXPECT_NE(failure.find("a larger cluster.max_workers"), std::string::npos) << failure;
  for (const std::size_t row : {1u, 3u}) {
    EXPECT_TRUE(table[row].at("failure").is_null()) << table[row];
    EXPECT_LT(mean_ms(table[row]), mean_ms(table[4])) << "more than with twelve";
    EXPECT_NE(table[row].at("variant").get<std::string>().find(",cluster.max_workers=16"),
              std::string::npos)
        << table[row];
  }
  EXPECT_EQ(mean_ms(table[1]), mean_ms(table[3]));
  EXPECT_LT(mean_ms(table[4]), mean_ms(table[0]));
  EXPECT_NE(table[1].at("why").get<std::string>().find("divided among more cores -"),
            std::string::npos)
      << table[1];
  EXPECT_GT(mean_ms(table[5]), mean_ms(table[0]));
  EXPECT_EQ(table[5].at("computed"), "run again");
  const ProgramResult shown = what_if({"cluster.workers=16"});
  EXPECT_EQ(shown.out.rfind("in short: cluster.workers=16: -", 0), 0u) << shown.out;
  EXPECT_NE(shown.out.find("with cluster.max_workers=16"), std::string::npos) << shown.out;
}

// Work that fits is replayed; what does not is computed again, and passes in tiles.
TEST_F(WhatIfCommand, AnotherL1MakesAnotherWorkWhereItMust) {
  const Json table = rows({"cluster.l1.size=32,64,128,256KiB"});
  ASSERT_EQ(table.size(), 5u);
  for (const Json& row : table) EXPECT_TRUE(row.at("failure").is_null()) << row;
  EXPECT_EQ(table[1].at("computed"), "run again");
  EXPECT_EQ(table[2].at("computed"), "run again");
  EXPECT_EQ(table[3].at("computed"), "replayed");
  EXPECT_EQ(table[4].at("computed"), "replayed");
  for (const std::size_t row : {1, 2, 3})
    EXPECT_EQ(table[row].at("why").get<std::string>().find("in tiles: ") != std::string::npos,
              row < 3)
        << table[row];
  EXPECT_EQ(table[1].at("variant"), "cluster.l1.size=32KiB");
  EXPECT_EQ(mean_ms(table[3]), mean_ms(table[0]));
  EXPECT_LT(mean_ms(table[2]), 1.10 * mean_ms(table[0]));
  // A run that was recorded in tiles is another in a larger L1, too.
  expect_done({"run", "--data", path("flight"), "-p", "cluster.l1.size=48KiB", "--out",
               path("small"), "--record", "--quiet"});
  const ProgramResult result =
      program({"whatif", path("small"), "cluster.l1.size=128KiB", "--quiet", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json larger = Json::parse(result.out).at("rows");
  EXPECT_EQ(larger[1].at("computed"), "run again");
  EXPECT_EQ(mean_ms(larger[1]), mean_ms(table[0]));
}

TEST_F(WhatIfCommand, HalfOfL1CostsNextATenthAtMost) {
  expect_done({"run", "--data", path("flight"), "--profile", "next", "--out", path("next"),
               "--record", "--quiet"});
  const ProgramResult result =
      program({"whatif", path("next"), "cluster.l1.size=64KiB", "--quiet", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json table = Json::parse(result.out).at("rows");
  EXPECT_EQ(table[1].at("computed"), "run again");
  EXPECT_LT(mean_ms(table[1]), 1.10 * mean_ms(table[0]));
}

TEST_F(WhatIfCommand, CausesAddUp) {
  const Json table = rows({"cluster.clock=1MHz", "cluster.clock=37MHz", "cluster.fpu.units=1"});
  for (std::size_t i = 1; i < table.size(); ++i) {
    const std::string why = table[i].at("why");
    double sum = 0;
    for (std::size_t at = 0; (at = why.find(" ms", at)) != std::string::npos; ++at)
      sum += std::stod(why.substr(why.rfind(' ', at - 1) + 1));
    const double difference = mean_ms(table[i]) - mean_ms(table[0]);
    EXPECT_NEAR(sum, difference, 0.2 * difference) << why;
  }
}

/// "What is Xpulp worth?": without the name of the chip, which the recording has.
TEST_F(WhatIfCommand, WhatTheChipExtendsIsAChangeOfTheRecordedChip) {
  const Json table = rows({"isa.base=rv32imfc", "gap9:isa.base=rv32imfc"});
  EXPECT_GT(mean_ms(table[1]), 1.2 * mean_ms(table[0]));
  EXPECT_EQ(mean_ms(table[1]), mean_ms(table[2]));
}

/// The command lines that a screen suggests work.
TEST_F(WhatIfCommand, WhatIsSuggestedWorks) {
  std::set<std::string> tried;
  for (const char* change : {"cluster.fpu.units=2", "isa.base=rv32imfc", "cluster.workers=16",
                             "cluster.l1.size=1KiB", "gap9-eigen"}) {
    const std::string out = what_if({change}).out;
    const std::size_t next = out.find("next: leviosim ");
    ASSERT_NE(next, std::string::npos) << out;
    const std::string suggested = out.substr(next + 15, out.find('\n', next) - next - 15);
    if (!tried.insert(suggested).second) continue;
    std::istringstream line(suggested);
    std::vector<std::string> words{std::istream_iterator<std::string>(line), {}};
    words.emplace_back("--quiet");
    std::replace(words.begin(), words.end(), std::string("whatif.html"), path("whatif.html"));
    const ProgramResult result = program(words);
    EXPECT_EQ(result.status, 0) << change << ": " << out << result.err;
  }
}

TEST_F(WhatIfCommand, SaysWhatIsOffloadedAndWhatNothingUses) {
  const Json table = rows({"gap9-hamming",
                           "gap9:controller.accelerators.hamming.units=1,"
                           "controller.accelerators.hamming.start_up=10,"
                           "controller.accelerators.hamming.latency=10,"
                           "controller.accelerators.hamming.items_per_cycle=1,"
                           "controller.accelerators.hamming.energy=1nJ"});
  EXPECT_NE(table[1].at("why").get<std::string>().find("offloaded to hamming -"), std::string::npos)
      << table[1];
  EXPECT_NE(table[2].at("why").get<std::string>().find("nothing of this run uses hamming"),
            std::string::npos)
      << table[2];
}

TEST_F(WhatIfCommand, AdvisesTheLargestLever) {
  const ProgramResult result = what_if({});
  ASSERT_EQ(result.status, 0) << result.err;
  std::istringstream in(result.out);
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(in, line)) {
    if (line.find(path("run")) == std::string::npos && line.rfind("in short: ", 0) != 0) {
      EXPECT_LE(display_width(line), 80) << line;
    }
    lines.push_back(line);
  }
  const auto at = [&](const std::string& part) {
    return std::find_if(lines.begin(), lines.end(),
                        [&](const std::string& l) { return l.find(part) != std::string::npos; }) -
           lines.begin();
  };
  EXPECT_EQ(result.out.rfind("in short: fastest is ", 0), 0u) << result.out;
  EXPECT_NE(result.out.find("; most per area: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(" brings nothing"), std::string::npos) << result.out;
  EXPECT_LT(at("cluster.icache.shared_size="), at("Least energy per frame:")) << result.out;
  EXPECT_LT(at("waiting for code -"), at("Least energy per frame:")) << result.out;
  // The fastest first, and no row for less than 1 %.
  double before = -100;
  for (const std::string& l : lines) {
    const std::size_t time = l.find(" % time");
    if (l.rfind("    ", 0) != 0 || time == std::string::npos) continue;
    const double gain = std::stod(l.substr(l.find_last_of(" ", time - 1) + 1));
    EXPECT_LE(gain, -1) << l;
    EXPECT_LE(before, gain + 0.1) << l;  // of rounded figures
    before = gain;
  }
  EXPECT_GT(before, -100) << "no gain at all";
  EXPECT_LT(at("Cannot run:"), static_cast<std::ptrdiff_t>(lines.size())) << result.out;
  // A larger memory is no gain, and not nothing either.
  const std::size_t costs = result.out.find("Gains no time, but costs:");
  ASSERT_NE(costs, std::string::npos) << result.out;
  EXPECT_NE(result.out.find("% energy)", costs), std::string::npos) << result.out;
}

TEST_F(WhatIfCommand, NamesAllAcceleratorsThatTakeOver) {
  const Json table = rows({"gap9-eigen", "cluster.fpu.units=8"});
  EXPECT_NE(table[1].at("why").get<std::string>().find("offloaded to eigen3, eigen9"),
            std::string::npos)
      << table[1];
  const ProgramResult same = what_if({"cluster.l1.size=256KiB"});
  EXPECT_NE(same.out.find("in short: no variant is faster than"), std::string::npos) << same.out;
}

TEST_F(WhatIfCommand, TableAndPageHoldAllRows) {
  const ProgramResult result =
      what_if({"cluster.fpu.units=2", "cluster.l1.size=1KiB", "--report", path("page.html")});
  EXPECT_EQ(result.status, 1) << "a row cannot run";
  for (const char* part : {"as it is", "cluster.fpu.units=2", "of 720 bytes does not fit",
                           "mean ms", "p99 ms", "fps", "mm2", "report: "})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " is not in:\n" << result.out;
  const std::string page = base::read_text_file(path("page.html"));
  EXPECT_NE(page.find("\"bars\""), std::string::npos);
  EXPECT_NE(page.find("cluster.fpu.units=2"), std::string::npos);
}

TEST_F(WhatIfCommand, TypingErrorsAreRefusedBeforeWork) {
  expect_refused(what_if({"cluster.fpu.unit=2"}),
                 {"cluster.fpu.unit=2", "did you mean 'cluster.fpu.units'?"});
  expect_refused(what_if({"technology=12nm"}), {"not modelled", "area.…"});
  expect_refused(what_if({"workload.epnp=off"}), {"not the chip", "leviosim run -p"});
  expect_refused(what_if({"gap9-eign"}), {"gap9-eign", "gap9-eigen"});
  expect_refused(what_if({"cluster.fpu.units="}),
                 {": cluster.fpu.units is empty", "expected a value"});
  expect_refused(what_if({"gap9:cluster.fpu.unit=2"}), {"cluster.fpu.unit", "cluster.fpu.units"});
  expect_refused(program({"whatif", path("flight")}), {"flight", "run with --record"});
}

TEST_F(WhatIfCommand, InlineVariantsArePlatformsEverywhere) {
  const std::string chip = "gap9:cluster.fpu.units=1";
  expect_done({"replay", path("run"), "--platform", chip, "--out", path("one"), "--quiet"});
  expect_done(
      {"replay", path("run"), "-p", "cluster.fpu.units=1", "--out", path("same"), "--quiet"});
  const auto statistics = [](const std::string& run) {
    return Json::parse(base::read_text_file(path(run + "/run.json"))).at("statistics");
  };
  EXPECT_EQ(statistics("one"), statistics("same"));
  std::ofstream(path("plan.yaml"))
      << "base: { trace: run }\npoints: { grid: { platform: [gap9, \"" << chip << "\"] } }\n";
  const ProgramResult swept =
      program({"sweep", path("plan.yaml"), "--out", path("swept"), "--quiet", "--json"});
  ASSERT_EQ(swept.status, 0) << swept.err;
  const Json points = Json::parse(swept.out).at("rows");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LT(points[0].at("objective.frame_time").get<double>(),
            points[1].at("objective.frame_time").get<double>());
  expect_refused(program({"replay", path("run"), "--platform", "gap9:cluster.fpu.unit=1", "--out",
                          path("none")}),
                 {"cluster.fpu.unit", "did you mean"});
}

}  // namespace
}  // namespace leviosim::tools
