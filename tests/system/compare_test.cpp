// Comparisons of a recorded flight on pairs of chips: parts add up, refusals name what differs.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/program_suite.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_report.h"
#include "tools/app/comparison/comparison_summary.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/record/record.h"
#include "tools/app/run/record_source.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using traces::testing::expect_input_error;

/// One second of flight, recorded once for all tests.
class Compare : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("compare");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("run"),
                 "--record", "--quiet"});
  }
  static RunRecord replayed(const std::vector<std::string>& overrides) {
    RecordOptions options;
    options.overrides = overrides;
    options.quiet = true;
    return replayed_run(path("run/work.trace"), options).record;
  }
  /// A copy of the run folder with another text in a file of it.
  static std::string changed_run(const std::string& file, const std::string& before,
                                 const std::string& after) {
    const std::string copy = path("changed");
    fs::remove_all(copy);
    fs::copy(path("run"), copy);
    fs::remove(copy + "/.leviosim-files");
    std::string text = base::read_text_file(copy + '/' + file);
    const auto at = text.find(before);
    EXPECT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
    std::ofstream(copy + '/' + file) << text;
    return copy;
  }
};

double difference(const ComparedQuantity& q) { return q.b.value_or(0) - q.a.value_or(0); }

/// The parts but for the rest explain the difference of the whole within 0.1 % of it. Rows are
/// rounded to a thousandth of a cycle of all calls.
void expect_adds_up(const ComparedQuantity& whole, const std::string& what) {
  double sum = 0;
  for (const ComparedQuantity& part : whole.parts)
    if (part.name != "rest") sum += difference(part);
  EXPECT_NEAR(sum, difference(whole), 1e-3 * std::abs(difference(whole)) + 0.1) << what;
}

/// A value for each of some parameters, drawn anew for every chip.
std::vector<std::string> random_chip(std::mt19937& random) {
  const auto draw = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const auto tenths = [&](int least, int n) {
    return fmt::format("{:.1f}", (least + draw(n)) / 10.0);
  };
  const std::vector<std::string> all{fmt::format("cluster.fpu.units={}", 1 << draw(4)),
                                     fmt::format("cluster.fpu.dividers={}", 1 + draw(4)),
                                     fmt::format("cluster.l1.banks={}", 8 << draw(3)),
                                     fmt::format("cluster.dma.bytes_per_cycle={}", 4 + 4 * draw(2)),
                                     fmt::format("cluster.events.offload={}", 100 + 50 * draw(8)),
                                     "isa.ops.int_alu.issue=" + tenths(10, 7),
                                     "isa.load_use_fraction=" + tenths(0, 6),
                                     "isa.ops.f32_fma.issue=" + tenths(10, 20),
                                     "isa.ops.load_stream.issue=" + tenths(10, 10),
                                     "isa.ops.call.issue=" + tenths(20, 200)};
  std::vector<std::string> some;
  for (const std::string& override : all)
    if (draw(2) == 0) some.push_back(override);
  return some;
}

TEST_F(Compare, PartsAddUpForRandomPairsOfChips) {
  std::mt19937 random(7);
  int differing = 0;
  for (int pair = 0; pair < 20; ++pair) {
    const RunRecord a = replayed(random_chip(random));
    const RunRecord b = replayed(random_chip(random));
    const RunComparison c = compare_runs(a, b, check_comparable(a, b, {}));
    EXPECT_TRUE(c.same_work());
    ASSERT_FALSE(c.stages.empty());
    expect_adds_up(c.frame, "frame");
    if (difference(c.frame) != 0) ++differing;
    for (const StageComparison& s : c.stages) {
      // Stages that never ran have nothing to compare.
      if (!s.mechanisms) continue;
      const std::string what = fmt::format("pair {}, {}", pair, s.stage.name);
      expect_adds_up(*s.mechanisms, what);
      expect_adds_up(*s.forks, what);
      for (const ComparedQuantity& mechanism : s.mechanisms->parts)
        if (!mechanism.parts.empty()) expect_adds_up(mechanism, what + ", " + mechanism.name);
      EXPECT_NEAR(s.causes.total(), difference(*s.mechanisms), 1e-6) << what;
      EXPECT_NEAR(s.causes.work, 0, 1e-6) << what;
    }
  }
  EXPECT_GT(differing, 15);
}

TEST_F(Compare, WhatCostsMoreIsNamed) {
  const RunRecord a = replayed({});
  const RunRecord b = replayed({"isa.ops.popcount.issue=3"});
  const RunComparison c = compare_runs(a, b);
  for (const StageComparison& s : c.stages) {
    if (s.stage.name != "frame matching") continue;
    ASSERT_TRUE(s.mechanisms.has_value());
    EXPECT_EQ(leaves_by_difference(*s.mechanisms).front().name, "issue: popcount");
    EXPECT_GT(s.causes.cost, 10 * std::abs(s.causes.contention));
    return;
  }
  FAIL() << "no such stage";
}

TEST_F(Compare, OneUnitLessIsWaitedFor) {
  const RunRecord a = replayed({});
  const RunRecord b = replayed({"cluster.fpu.units=1"});
  const RunComparison c = compare_runs(a, b);
  for (const StageComparison& s : c.stages)
    if (s.stage.name == "8-point RANSAC" && s.calls.a.value_or(0) > 0) {
      EXPECT_EQ(leaves_by_difference(*s.mechanisms).front().name, "fpu");
      EXPECT_EQ(s.causes.cost, 0);
    }
  EXPECT_NE(work_line(c).find("the same"), std::string::npos);
}

TEST_F(Compare, TheFolderOfARunSaysWhatItsReplaySays) {
  const RunRecord run = read_run_folder(path("run"), false).record;
  const RunRecord again = replayed({});
  const RunComparison c = compare_runs(run, again);
  for (const ComparedQuantity& q : c.figures) EXPECT_EQ(q.a, q.b) << q.name;
  EXPECT_EQ(difference(c.frame), 0);
  EXPECT_TRUE(c.blocks.empty());
}

TEST_F(Compare, TheRecordOfAFolderIsThatOfItsReplay) {
  const RunRecord run = replayed({});
  const RunRecord folder = read_run_folder(path("run"), false).record;
  EXPECT_EQ(record_json(run).at("stages"), record_json(folder).at("stages"));
  EXPECT_EQ(csv_text(cycle_rows(run.cycles)), base::read_text_file(path("run/cycles.csv")));
}

TEST_F(Compare, TextFitsEightyColumns) {
  const RunRecord a = replayed({});
  const RunRecord b = replayed({"isa.ops.load_stream.issue=1.6"});
  const RunComparison c = compare_runs(a, b);
  const std::string text = comparison_report({c}, ReportFormat::text, true);
  EXPECT_EQ(text, comparison_report(c, ReportFormat::text));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), 80) << line;
}

TEST_F(Compare, TheProgramPrintsAllFormats) {
  for (const char* format : {"text", "markdown", "json", "csv"}) {
    const ProgramResult result = program(
        {"compare", path("run"), "-p", "cluster.fpu.dividers=2", "--quiet", "--format", format});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("cluster.fpu.dividers=2"),
              format == std::string("csv") ? 0u : std::string::npos);
    if (format == std::string("json")) {
      const Json json = Json::parse(result.out);
      EXPECT_EQ(json.at("same_work"), true);
      EXPECT_FALSE(json.at("stages").at(0).at("by_mechanism").at("parts").empty());
    }
  }
}

TEST_F(Compare, RunsThatAreTimedOnAnotherChipAreCalledSo) {
  const ProgramResult result = program({"compare", path("run"), path("run"), "-p",
                                        "cluster.fpu.dividers=2", "--quiet", "--format", "json"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* run : {"a", "b"})
    EXPECT_EQ(Json::parse(result.out).at(run).at("name"),
              path("run") + "/work.trace, cluster.fpu.dividers=2");
}

TEST_F(Compare, TheSummaryFitsAScreen) {
  const RunRecord a = replayed({});
  for (const char* change :
       {"cluster.fpu.units=1", "isa.ops.int_alu.issue=1.4", "cluster.icache.shared_size=16KiB",
        "cluster.clock=185MHz", "isa.ops.popcount.issue=3"}) {
    const RunRecord b = replayed({change});
    const std::string text = comparison_summary(compare_runs(a, b));
    std::istringstream in(text);
    int lines = 0;
    for (std::string line; std::getline(in, line); ++lines)
      EXPECT_LE(display_width(line), 80) << line;
    EXPECT_LE(lines, 24) << text;
    for (const char* part : {"frame time, mean", "why a mean frame takes another time:", "--all"})
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  }
}

TEST_F(Compare, TheSummaryNamesTheCauses) {
  const auto compared = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"compare", path("run")});
    words.emplace_back("--quiet");
    const ProgramResult result = program(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  const auto expect = [](const std::string& text, std::vector<const char*> parts,
                         const char* not_there) {
    for (const char* part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
    EXPECT_EQ(text.find(not_there), std::string::npos) << text;
  };
  expect(compared({"-p", "cluster.fpu.units=1"}), {"waiting for a shared FPU +"}, "CHANGED");
  expect(compared({"--platform", "gap9-hamming"}), {"work moved: ", "offloaded to hamming -"},
         "CHANGED");
  expect(compared({"--platform",
                   "gap9:controller.accelerators.hamming.units=1,"
                   "controller.accelerators.hamming.start_up=10,"
                   "controller.accelerators.hamming.latency=10,"
                   "controller.accelerators.hamming.items_per_cycle=1,"
                   "controller.accelerators.hamming.energy=1nJ"}),
         {"nothing of this run uses hamming (controller),", "because its work has no region"},
         "offloaded");
  expect_done({"run", "--data", path("flight"), "--platform",
               "gap9:cluster.workers=16,cluster.max_workers=16,cluster.l1.size=256KiB", "--out",
               path("sixteen"), "--quiet"});
  expect(compared({path("sixteen")}), {"divided among more cores -"}, "price of an operation");
}

/// The columns of a page say what differs, not twice the name of the run.
TEST_F(Compare, NamesAPagesColumnsByTheChange) {
  expect_done({"compare", path("run"), "-p", "cluster.fpu.dividers=2", "--quiet", "--report",
               path("divided.html")});
  const std::string page = base::read_text_file(path("divided.html"));
  for (const char* name : {"\"name\":\"as recorded\"", "\"name\":\"cluster.fpu.dividers=2\""})
    EXPECT_NE(page.find(name), std::string::npos) << name;
}

TEST_F(Compare, RefusesOtherInputsUnlessTheyAreMeant) {
  struct Row {
    const char* before;
    const char* after;
    const char* key;
  };
  for (const Row& row : {Row{"\"seed\": 1", "\"seed\": 2", "seed"},
                         Row{"\"image\": [160", "\"image\": [320", "size"},
                         Row{"\"profile\": \"levio\"", "\"profile\": \"next\"", "profile"},
                         Row{"\"first_frame\": 0", "\"first_frame\": 3", "frames"},
                         Row{"sensor.yaml\":\"", "sensor.yaml\":\"0", "data"}}) {
    const std::string other = changed_run("run.json", row.before, row.after);
    expect_refused(program({"compare", path("run"), other}),
                   {"cannot be compared", std::string("--allow ") + row.key});
    const ProgramResult allowed = program({"compare", path("run"), other, "--allow", row.key});
    EXPECT_EQ(allowed.status, 0) << allowed.err;
    EXPECT_NE(allowed.out.find("note: other"), std::string::npos) << allowed.out;
  }
}

TEST_F(Compare, NotesOtherVersions) {
  const std::string other = changed_run("run.json", "\"program\": \"0.1.0", "\"program\": \"0.0.9");
  const ProgramResult result = program({"compare", path("run"), other});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("note: program:"), std::string::npos) << result.out;
}

TEST_F(Compare, RefusesWhatIsNoRun) {
  expect_refused(program({"compare"}), {"RUN is missing"});
  expect_refused(program({"compare", path("run")}), {"only", "--platform"});
  expect_refused(program({"compare", path("run"), path("nowhere")}), {"nowhere", "does not exist"});
  expect_refused(program({"compare", path("run"), path("flight")}), {"no run folder"});
  expect_refused(program({"compare", path("run"), path("run"), "--allow", "sed"}),
                 {"--allow 'sed'", "did you mean 'seed'"});
  expect_refused(program({"compare", path("run"), path("run"), "--format", "jsn"}),
                 {"did you mean 'json'"});
  expect_refused(program({"compare", path("run"), changed_run("run.json", "{", "[")}),
                 {"run.json"});
  expect_refused(
      program({"compare", path("run"), changed_run("run.json", "\"seed\": 1", "\"seed\": \"x\"")}),
      {"run.json"});
  expect_refused(program({"compare", path("run"), changed_run("run.json", "\"issue ", "\"isue ")}),
                 {"run.json"});
}

}  // namespace
}  // namespace leviosim::tools
