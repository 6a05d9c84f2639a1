// check, budget, and --budget as users and CI servers meet them; the project's own budgets.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/paths.h"
#include "tests/support/program_suite.h"
#include "tests/tools/junit_schema.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/gate.h"
#include "tools/app/record/statistic_list.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::junit_fault;
using testing::ProgramResult;

/// One second of flight, recorded once, with its baseline and a first budget.
class Check : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("check");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    ProgramResult result = program({"run", "--platform", "gap9", "--data", path("flight"), "--out",
                                    path("run"), "--record", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    result = program({"budget", "record", path("run")});
    ASSERT_EQ(result.status, 0) << result.err;
    write("baseline.json", result.out);
    result = program({"budget", "init", path("run"), "--margin", "3 %"});
    ASSERT_EQ(result.status, 0) << result.err;
    write("budgets.yaml", result.out);
  }
  static std::string write(const std::string& name, const std::string& text) {
    std::ofstream(*folder_ / name) << text;
    return path(name);
  }
  static void expect_holds(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
  }
};

TEST_F(Check, AFirstBudgetIsMetByItsRunAndItsTrace) {
  for (const char* run : {"run", "run/work.trace"}) {
    const ProgramResult result =
        program({"check", path(run), "--budget", path("budgets.yaml"), "--quiet"});
    EXPECT_EQ(result.status, 0) << result.out << result.err;
    expect_holds(result.out, {"0 not met"});
  }
}

TEST_F(Check, AStageThatBecameSlowerEndsWithStatusOneAndSaysWhy) {
  const std::string budget = write("slower.yaml",
                                   "budgets:\n  - limits:\n      - stage: frame matching\n"
                                   "        limit: cycles <= +3 %\n        owner: vision\n");
  fs::remove(path("junit.xml"));
  const ProgramResult result =
      program({"check", path("run"), "-p", "isa.ops.popcount.issue=2", "--quiet", "--budget",
               budget, "--baseline", path("baseline.json"), "--junit", path("junit.xml"),
               "--annotations", "github"});
  EXPECT_EQ(result.status, 1) << result.out << result.err;
  EXPECT_EQ(result.err, "");
  expect_holds(result.out, {"1 not met", "where: frame matching, ", "why: issue: popcount +",
                            "owner: vision", "::error file=", "line=3,"});
  const std::string junit = base::read_text_file(path("junit.xml"));
  EXPECT_EQ(junit_fault(junit), "");
  expect_holds(junit, {"failures=\"1\"", "popcount"});
}

/// What xmllint says against a JUnit file (junit.xsd); empty if it is as CI servers read it.
std::string schema_fault(const std::string& file) {
  const fs::path schema = tests::source_folder() / "tests/system/junit.xsd";
  const std::string said = file + ".said";
  const int status = std::system(  // NOLINT: the command is the test's own
      fmt::format("xmllint --noout --nonet --schema '{}' '{}' 2>'{}'", schema.string(), file, said)
          .c_str());
  const std::string text = base::read_text_file(said);
  if (WEXITSTATUS(status) == 127)
    return "xmllint is missing; tools/setup.sh tests installs it (package libxml2-utils): " + text;
  return status == 0 ? std::string() : text;
}

TEST_F(Check, JUnitIsAsItsSchemaSays) {
  const std::string odd =
      write("odd & <b>.yaml",
            "budgets:\n"
            "  - name: \"a&b <c> \\\"d\\\" 'e' \\x07\\e[1m \\u2028 \\uFFFF ]]> --> \\u00e9\"\n"
            "    owner: \"<&>\\x01\"\n"
            "    reason: \"]]> \\t \\n <!-- \\u202e\"\n"
            "    limits:\n"
            "      - L1 peak <= 1 kB\n"
            "      - stage: \"*\"\n"
            "        limit: cycles <= 1 cycles\n"
            "  - name: \"\"\n"
            "    limits: [L1 peak <= 1 MB]\n");
  const std::string tight = write("tight.yaml", "budgets:\n  - limits: [L1 peak <= 1 kB]\n");
  const std::string junit = path("schema.xml");
  for (const std::string& budget : {path("budgets.yaml"), tight, odd}) {
    const ProgramResult result =
        program({"check", path("run"), "--budget", budget, "--quiet", "--force", "--junit", junit});
    EXPECT_EQ(result.status, budget == path("budgets.yaml") ? 0 : 1) << result.err;
    EXPECT_EQ(schema_fault(junit), "") << base::read_text_file(junit);
    EXPECT_EQ(junit_fault(base::read_text_file(junit)), "");
  }
  expect_holds(base::read_text_file(junit),
               {"a&amp;b &lt;c&gt; &quot;d&quot; &#39;e&#39; \\x07\\x1b[1m"});
  const std::string good = base::read_text_file(junit);
  for (const auto& [before, after] :
       std::vector<std::pair<std::string, std::string>>{{" skipped=\"0\"", ""},
                                                        {" time=\"0\"", " time=\"soon\""},
                                                        {" classname=", " class="},
                                                        {"<failure type=\"limit\"", "<failure"},
                                                        {"<testsuite ", "<suite "},
                                                        {"&amp;", "&"}}) {
    std::string bad = good;
    const auto at = bad.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    EXPECT_NE(schema_fault(write("bad.xml", bad.replace(at, before.size(), after))), "") << after;
  }
}

TEST_F(Check, RunAndReplayHoldABudgetToo) {
  const std::string tight = write("tight.yaml", "budgets:\n  - limits: [L1 peak <= 1 kB]\n");
  for (const bool replay : {false, true}) {
    std::vector<std::string> words =
        replay ? std::vector<std::string>{"replay", path("run")}
               : std::vector<std::string>{"run", "--platform", "gap9", "--data", path("flight")};
    const std::string out = path(replay ? "replayed" : "again");
    words.insert(words.end(), {"--out", out, "--quiet", "--budget", tight});
    const ProgramResult result = program(words);
    EXPECT_EQ(result.status, 1) << result.err;
    expect_holds(result.out, {"results: ", "NOT MET", "L1 peak <= 1 kB"});
    EXPECT_TRUE(fs::exists(out + "/run.json"));  // the run itself is fine
    words.insert(words.end(), {"--force", "--baseline", path("baseline.json")});
    words[words.size() - 4] = path("budgets.yaml");
    EXPECT_EQ(program(words).status, 0);
  }
}

TEST_F(Check, JsonHoldsAllFindings) {
  const ProgramResult result =
      program({"check", path("run"), "--budget", path("budgets.yaml"), "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json.at("not_met"), 0);
  EXPECT_EQ(json.at("findings").size(), json.at("limits").get<std::size_t>());
}

TEST_F(Check, ABaselineIsAFewKilobytesAndARunServesAsOne) {
  EXPECT_LT(fs::file_size(path("baseline.json")), 16'000u);
  const std::string budget =
      write("same.yaml", "budgets:\n  - limits:\n      - frame latency p99 <= +0 %\n");
  for (const char* baseline : {"baseline.json", "run", "run/work.trace"})
    EXPECT_EQ(
        program({"check", path("run"), "--budget", budget, "--baseline", path(baseline), "--quiet"})
            .status,
        0)
        << baseline;
}

TEST_F(Check, RefusesBadInput) {
  const std::string budget = path("budgets.yaml");
  expect_refused(program({"check"}), {"RUN is missing"});
  expect_refused(program({"check", path("run")}), {"--budget is missing", "budget init"});
  expect_refused(program({"check", path("run"), "--budget", path("none.yaml")}), {"none.yaml"});
  expect_refused(program({"check", path("none"), "--budget", budget}), {"none", "does not exist"});
  expect_refused(program({"check", path("run"), "--budget", budget, "--annotations", "gitea"}),
                 {"--annotations 'gitea'", "github or gitlab"});
  expect_refused(program({"check", path("run"), "--budget", budget, "--baseline", budget}),
                 {"budgets.yaml", "a run folder, a work trace, or a JSON file", "budget record"});
  expect_refused(
      program({"check", path("run"), "--budget", budget, "--baseline", write("no.json", "{}")}),
      {"no.json", "budget record"});
  expect_refused(program({"check", path("run"), "--budget", budget, "--junit", budget}),
                 {"--junit"});
  expect_refused(program({"run", "--platform", "gap9", "--data", path("flight"), "--out",
                          path("never"), "--budget", path("none.yaml")}),
                 {"none.yaml"});
  EXPECT_FALSE(fs::exists(path("never")));
  expect_refused(program({"budget", "recrod", path("run")}), {"did you mean 'record'"});
  expect_refused(program({"budget", "init", path("run"), "--margin", "5"}), {"--margin '5'"});
  std::string other = base::read_text_file(path("baseline.json"));
  other.replace(other.find("\"seed\": 1"), 9, "\"seed\": 2");
  expect_refused(
      program({"check", path("run"), "--budget", budget, "--baseline", write("seed.json", other)}),
      {"cannot be compared", "--allow seed"});
}

/// Unused room goes, what is tight stays, and all else of the file does.
TEST_F(Check, TightenTakesBackUnusedRoom) {
  const std::string loose = write("loose.yaml",
                                  "# ours\nbudgets:\n  - limits:\n"
                                  "      - L1 peak <= 128 kB  # of 128 KiB\n"
                                  "      - { stage: frame matching, limit: cycles <= 90 Mcycles }\n"
                                  "      - frame latency p99 <= +3 %\n");
  const ProgramResult tight = program({"budget", "tighten", path("run"), "--budget", loose,
                                       "--slack", "2 %", "--baseline", path("baseline.json")});
  ASSERT_EQ(tight.status, 0) << tight.err;
  expect_holds(tight.out, {"# ours\n", "kB  # of 128 KiB", "frame latency p99 <= +3 %"});
  EXPECT_EQ(tight.out.find("90 Mcycles"), std::string::npos) << tight.out;
  const std::string file = write("tight2.yaml", tight.out);
  const std::string again = program({"budget", "tighten", path("run"), "--budget", file, "--slack",
                                     "2 %", "--baseline", path("baseline.json")})
                                .out;
  EXPECT_EQ(again, tight.out) << "a second time changes nothing";
  const std::vector<std::string> check{"check",      path("run"),           "--budget", file,
                                       "--baseline", path("baseline.json"), "--quiet"};
  EXPECT_EQ(program(check).status, 0);
  std::vector<std::string> slower = check;
  slower.insert(slower.end(), {"-p", "isa.ops.int_alu.issue=1.4"});
  EXPECT_EQ(program(slower).status, 1);
}

TEST_F(Check, AnAcceptedMissPassesUntilItsDay) {
  const std::string tight = write("miss.yaml", "budgets:\n  - limits: [L1 peak <= 1 kB]\n");
  const auto accept = [&](const std::string& until) {
    return program({"budget", "accept", path("run"), "--budget", tight, "--reason",
                    "the radio moves", "--until", until});
  };
  const ProgramResult accepted = accept("2099-12-31");
  ASSERT_EQ(accepted.status, 0) << accepted.err;
  const ProgramResult passes =
      program({"check", path("run"), "--budget", write("accepted.yaml", accepted.out)});
  EXPECT_EQ(passes.status, 0) << passes.out;
  expect_holds(passes.out, {"warning", "accepted up to 112 kB until"});
  const auto checked = [&](const std::string& from, const std::string& to) {
    std::string text = accepted.out;
    text.replace(text.find(from), from.size(), to);
    return program({"check", path("run"), "--budget", write("over.yaml", text)});
  };
  const ProgramResult over = checked("2099-12-31", "2001-01-01");
  EXPECT_EQ(over.status, 1) << over.out;
  expect_holds(over.out, {"was accepted up to 112 kB"});
  expect_refused(checked("2099-12-31", "2027-02-30"),
                 {"over.yaml:", "2027-02-30", "a day such as"});
  expect_refused(checked("limit: \"L1 peak", "limit: \"L1 peek"),
                 {"over.yaml:", "'L1 peek <= 1 kB'", "did you mean 'L1 peak <= 1 kB'?"});
  expect_refused(accept("2001-01-01"), {"--until '2001-01-01'", "is over"});
  expect_refused(accept("soon"), {"--until 'soon'", "2026-12-24"});
  expect_refused(program({"budget", "accept", path("run"), "--budget", path("budgets.yaml"),
                          "--reason", "r", "--until", "2099-12-31"}),
                 {"meets all limits"});
}

/// What was accepted has a bound of its own: a run that is worse fails again.
TEST_F(Check, AnAcceptedMissHasABound) {
  const std::string tight = write("miss2.yaml",
                                  "budgets:\n  - limits:\n      - frame latency mean <= 1 us\n"
                                  "      - L1 peak <= 1 kB\n");
  std::vector<std::string> accept{"budget",  "accept",  path("run"),  "--budget", tight, "--reason",
                                  "a radio", "--until", "2099-12-31", "--margin", "3 %"};
  expect_refused(program(accept), {"2 limits fail; expected --limit", "frame latency mean <= 1 us",
                                   "L1 peak <= 1 kB"});
  accept.insert(accept.end(), {"--limit", "L1 peek <= 1 kB"});
  expect_refused(program(accept), {"--limit 'L1 peek", "did you mean 'L1 peak <= 1 kB'?"});
  accept.back() = "L1 peak <= 1 kB";
  accept.insert(accept.end(), {"--limit", "frame latency mean <= 1 us"});
  const ProgramResult accepted = program(accept);
  ASSERT_EQ(accepted.status, 0) << accepted.err;
  expect_holds(accepted.out, {"bound: ", " us\n", " kB\n"});
  const std::string file = write("accepted2.yaml", accepted.out);
  const ProgramResult passes = program({"check", path("run"), "--budget", file});
  EXPECT_EQ(passes.status, 0) << passes.out;
  expect_holds(passes.out, {"accepted up to "});
  const std::vector<std::string> slower{
      "check", path("run"), "--budget", file, "--all", "-p", "isa.ops.int_alu.issue=1.5"};
  const ProgramResult fails = program(slower);
  EXPECT_EQ(fails.status, 1) << fails.out;
  expect_holds(fails.out, {"was accepted up to ", " only: a radio"});
}

/// Another clock is named as what it is, also without a baseline: the chip of the recording is one.
TEST_F(Check, NamesTheClockThatMadeItLate) {
  const std::string tight =
      write("late.yaml", "budgets:\n  - limits: [frame latency mean <= 1 us]\n");
  const ProgramResult slow =
      program({"check", path("run"), "--budget", tight, "--all", "-p", "cluster.clock=150MHz"});
  EXPECT_EQ(slow.status, 1);
  expect_holds(slow.out, {"another clock +", " ms"});
  EXPECT_EQ(slow.out.find("kcycles of a frame"), std::string::npos) << slow.out;
  // A reason whose sign opposes the miss is none.
  EXPECT_EQ(slow.out.find(" -0."), std::string::npos) << slow.out;
}

TEST_F(Check, AWarningDoesNotFail) {
  const std::string warn = write(
      "warn.yaml", "budgets:\n  - limits:\n      - { limit: L1 peak <= 1 kB, level: warn }\n");
  fs::remove(path("warned.xml"));
  const ProgramResult result =
      program({"check", path("run"), "--budget", warn, "--annotations", "github", "--junit",
               path("warned.xml"), "--markdown", path("warned.md")});
  EXPECT_EQ(result.status, 0) << result.out;
  expect_holds(result.out, {"warning", "::warning file=", "0 not met, 1 warning\n"});
  EXPECT_EQ(junit_fault(base::read_text_file(path("warned.xml"))), "");
  EXPECT_EQ(schema_fault(path("warned.xml")), "");
  expect_holds(base::read_text_file(path("warned.md")), {"met, with warnings", "**⚠ L1 peak"});
  expect_refused(
      program({"check", path("run"), "--budget",
               write("level.yaml",
                     "budgets:\n  - limits:\n      - { limit: L1 peak <= 1 kB, level: loud }\n")}),
      {"level.yaml:3", "level 'loud'", "fail or warn"});
}

TEST_F(Check, WhatBecameBetterIsSaidAndThatTheBaselineIsStale) {
  const std::string budget = write(
      "better.yaml", "budgets:\n  - limits: [{ stage: frame matching, limit: cycles <= +1 % }]\n");
  const ProgramResult result = program(
      {"check", path("run/work.trace"), "-p", "isa.ops.popcount.issue=0.5", "--budget", budget,
       "--baseline", path("baseline.json"), "--markdown", path("better.md"), "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_holds(result.out, {"better  frame matching: cycles <= +1 %", "a figure is better than ",
                            "budget record", "stale"});
  expect_holds(
      base::read_text_file(path("better.md")),
      {"**✓ frame matching: cycles", "% better than the baseline", "The baseline is stale"});
}

TEST_F(Check, ABaselineOfAnotherChipIsRefusedUnlessAllowed) {
  const std::string budget = write("chip.yaml", "budgets:\n  - limits: [frame cycles <= +900 %]\n");
  std::vector<std::string> words{
      "check", path("run/work.trace"), "--platform",          "gap9-hamming", "--budget",
      budget,  "--baseline",           path("baseline.json"), "--quiet"};
  expect_refused(program(words), {"other chip (gap9 and gap9-hamming)", "--allow chip"});
  words.insert(words.end(), {"--allow", "chip"});
  const ProgramResult allowed = program(words);
  EXPECT_EQ(allowed.status, 0) << allowed.err;
}

/// It has its name in run folders, too.
TEST_F(Check, AStageWithoutCallsIsNamedLikeOthers) {
  for (const char* stage : {"EPnP RANSAC", "epnp_ransac", "EPnP*"}) {
    const std::string budget = write(
        "epnp.yaml", fmt::format("budgets:\n  - limits:\n      - stage: {}\n        limit: cycles "
                                 "<= 1 Mcycles\n",
                                 stage));
    const ProgramResult result = program({"check", path("run"), "--budget", budget});
    EXPECT_EQ(result.status, 1) << result.err << result.out;
    expect_holds(result.out, {"EPnP RANSAC: cycles <= 1 Mcycles", "the run has no such value"});
  }
}

/// A stage that the baseline ran without has no bound; of one that neither ran, nothing changed.
TEST_F(Check, AStageWithoutCallsIsNoMissAgainstAHistory) {
  const std::string budget =
      write("every.yaml", "budgets:\n  - limits: [{ stage: \"*\", limit: cycles <= +1 % }]\n");
  const std::string file = path("every.jsonl");
  ASSERT_EQ(program({"history", "add", path("run"), "--file", file, "--commit", "a1", "--branch",
                     "main", "--time", "1", "--subject", "s"})
                .status,
            0);
  const ProgramResult result =
      program({"check", path("run"), "--budget", budget, "--history", file, "--commit", "a2"});
  EXPECT_EQ(result.status, 0) << result.err << result.out;
}

/// A job that is run again does not find its own miss to be older than itself.
TEST_F(Check, ItsOwnCommitIsNoHistory) {
  const std::string budget = write(
      "again.yaml", "budgets:\n  - limits: [{ stage: frame matching, limit: cycles <= +1 % }]\n");
  const std::string file = path("again.jsonl");
  const auto add = [&](const std::string& commit, const std::string& time,
                       const std::string& popcount) {
    EXPECT_EQ(program({"history", "add", path("run/work.trace"), "-p",
                       "isa.ops.popcount.issue=" + popcount, "--file", file, "--commit", commit,
                       "--branch", "main", "--time", time, "--subject", "s", "--quiet"})
                  .status,
              0);
  };
  const auto check = [&](const std::string& commit) {
    return program({"check", path("run/work.trace"), "-p", "isa.ops.popcount.issue=2", "--budget",
                    budget, "--history", file, "--commit", commit, "--quiet"})
        .status;
  };
  add("a1", "1", "1");
  EXPECT_EQ(check("a2"), 1);
  add("a2", "2", "2");
  EXPECT_EQ(check("a2"), 1);
  EXPECT_EQ(check("a3"), 0) << "it was so before";
}

/// Lines of an example that a shell runs.
std::string commands_of(const std::string& file) {
  std::istringstream lines(base::read_text_file((tests::source_folder() / ("tools/ci/" + file))));
  std::string commands;
  for (std::string line; std::getline(lines, line);)
    if (const auto begin = line.find_first_not_of(' ');
        begin != std::string::npos &&
        (line.compare(begin, 9, "leviosim ") == 0 || line.compare(begin, 6, "touch ") == 0))
      commands += line.substr(begin) + '\n';
  return commands;
}

/// As a CI server runs them, in a folder with a budget and a baseline. @returns exit status
int run_script(const fs::path& folder, const std::string& commands) {
  const fs::path bin = folder / "bin";
  fs::create_directories(bin);
  fs::remove(bin / "leviosim");
  fs::create_symlink(tests::program_path(), bin / "leviosim");
  std::ofstream(folder / "script.sh") << "set -eu\ncd '" << folder.string() << "'\nPATH='"
                                      << bin.string() << "':$PATH\nexport DATA=../flight\n"
                                      << "export GITHUB_REF_NAME=main CI_COMMIT_REF_NAME=main\n"
                                      << commands;
  const int status = std::system(
      fmt::format("sh {} >{} 2>&1", (folder / "script.sh").string(), (folder / "log").string())
          .c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A repository with the commit that is checked out.
constexpr const char* kCheckout = R"sh(
export GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@example.org GIT_COMMITTER_NAME=a
export GIT_COMMITTER_EMAIL=a@example.org GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
[ -e .git ] || git init -q -b main
git commit -q --allow-empty -m change
)sh";

TEST_F(Check, TheExamplesForServersWork) {
  if (std::system("git --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "git is not installed";
  for (const char* file : {"github.yml", "gitlab.yml"}) {
    const std::string commands = commands_of(file);
    ASSERT_NE(commands.find("leviosim check"), std::string::npos) << file;
    const fs::path folder = *folder_ / (std::string(file) + ".d");
    fs::create_directories(folder);
    fs::copy(path("baseline.json"), folder / "baseline.json");
    fs::copy(path("budgets.yaml"), folder / "budgets.yaml");
    const auto log = [&] { return base::read_text_file(folder / "log"); };
    EXPECT_EQ(run_script(folder, kCheckout + commands), 0) << log();
    EXPECT_EQ(junit_fault(base::read_text_file(folder / "junit.xml")), "");
    // The next job of a server finds what this one left: of the same commit, and of another.
    EXPECT_EQ(run_script(folder, commands), 0) << log();
    EXPECT_NE(log().find("is in history.jsonl already"), std::string::npos) << log();
    EXPECT_EQ(run_script(folder, kCheckout + commands), 0) << log();
    EXPECT_NE(log().find("is run 2 of history.jsonl"), std::string::npos) << log();
    EXPECT_TRUE(fs::exists(folder / "trend.html"));
    // A limit that no run met before would be a warning: that is not of this change.
    std::ofstream(folder / "budgets.yaml") << "budgets:\n  - limits: [L1 peak <= 1 kB]\n";
    fs::remove(folder / "history.jsonl");
    EXPECT_EQ(run_script(folder, commands), 1) << log();
  }
}

/// The relative limits of the project's own budgets on one second of flight.
TEST_F(Check, TheProjectsGateSeesACostThatRoseByFourPerCent) {
  const std::string budget = (tests::source_folder() / ("tools/ci/budgets.yaml")).string();
  const ProgramResult recorded = program({"budget", "record", path("run"), "--budget", budget});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  const std::string baseline = write("own.json", recorded.out);
  const auto check = [&](const std::string& override) {
    return program({"check", path("run"), "-p", override, "--quiet", "--budget", budget,
                    "--baseline", baseline, "--json"});
  };
  const auto misses = [](const ProgramResult& result) {
    std::map<std::string, std::string> why;  // limit → first reason
    const Json json = Json::parse(result.out);
    for (const Json& f : json.at("findings"))
      if (!f.at("met").get<bool>() && f.contains("stage"))
        why[f.at("stage").get<std::string>() + ": " + f.at("limit").get<std::string>()] =
            f.at("why").at(0).get<std::string>();
    return why;
  };
  const ProgramResult same = check("isa.ops.popcount.issue=1");
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  const ProgramResult popcount = check("isa.ops.popcount.issue=1.04");
  EXPECT_EQ(popcount.status, 1) << popcount.err;
  const auto matching = misses(popcount);
  ASSERT_EQ(matching.count("frame matching: cycles <= +0.1 %"), 1u) << popcount.out;
  EXPECT_EQ(matching.at("frame matching: cycles <= +0.1 %").rfind("issue: popcount +", 0), 0u);
  EXPECT_EQ(matching.count("feature extraction: cycles <= +0.1 %"), 0u);
  const ProgramResult fma = check("isa.ops.f32_fma.issue=1.04");
  EXPECT_EQ(fma.status, 1) << fma.err;
  EXPECT_EQ(misses(fma).count("frame matching: cycles <= +0.1 %"), 0u) << fma.out;
}

TEST(ProjectBudgets, HaveBaselinesOfBothProfiles) {
  const Budget budget = read_budget((tests::source_folder() / ("tools/ci/budgets.yaml")).string());
  for (const char* profile : {"levio", "next"}) {
    const std::string file = fmt::format("tools/ci/{}-gap9.json", profile);
    const RunRecord baseline =
        parse_record(file, base::read_text_file(tests::source_folder() / file), Level::kept);
    EXPECT_EQ(baseline.facts.profile, profile);
    EXPECT_FALSE(sections_for(budget, baseline).empty());
  }
}

}  // namespace
}  // namespace leviosim::tools
