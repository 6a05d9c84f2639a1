// Runs over time as a firmware team has them: a repository in which one kernel became slower at one
// commit, and another drifted, each time by less than its limit.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <set>

#include "tests/support/paths.h"
#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "tests/support/text_lines.h"
#include "tools/app/history/history.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using tests::lines_of;

/// Thirty commits: a chip's numbers in a file, by which a recorded second of flight is replayed.
/// Matching takes longer from commit 17 on; extraction drifts at ten others. Four commits
/// do not build.
constexpr const char* kStory = R"sh(
set -eu
export GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@example.org GIT_COMMITTER_NAME=a
export GIT_COMMITTER_EMAIL=a@example.org GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
mkdir repository
cd repository
git init -q -b main
drift=0
popcount=1
for n in $(seq 1 30); do
  subject="work on something else"
  if [ $n = 17 ]; then popcount=1.22; subject="count bits one by one"; fi
  case $n in 3|5|8|10|13|15|19|22|25|28) drift=$((drift + 1)); subject="small change";; esac
  echo "-p isa.ops.popcount.issue=$popcount -p isa.ops.int_min_max.issue=1.$(printf %02d $((2 * drift)))" >chip
  case $n in 14|15|22|23) echo broken >build;; *) echo fine >build;; esac
  echo $n >number
  git add .
  export GIT_AUTHOR_DATE="$((1760000000 + 1000 * n)) +0000"
  export GIT_COMMITTER_DATE="$GIT_AUTHOR_DATE"
  git commit -q -m "$subject"
  git tag c$n
  if [ $n = 17 ]; then
    leviosim check ../run/work.trace $(cat chip) --budget ../all.yaml --history ../history.jsonl \
      --markdown ../comment.md --quiet >../check17.txt || echo "status $?" >>../check17.txt
  fi
  leviosim history add ../run/work.trace $(cat chip) --budget ../all.yaml --baseline ../baseline.json \
    --file ../history.jsonl --quiet >/dev/null
done
leviosim check ../run/work.trace $(cat chip) --budget ../all.yaml --history ../history.jsonl --quiet \
  --json >../check30.json || echo "status $?" >../check30.status
leviosim history show --file ../history.jsonl --budget ../all.yaml >../show.txt
leviosim history page --file ../history.jsonl --budget ../all.yaml --out ../trend.html >/dev/null
cat >../build.sh <<'SH'
grep -q fine build
leviosim replay ../run/work.trace $(cat chip) --out ../bisected --force --quiet >/dev/null
SH
git bisect start c30 c1 >../bisect.txt 2>&1
git bisect run leviosim bisect ../bisected --budget ../matching.yaml --baseline ../baseline.json \
  -- sh -e ../build.sh >>../bisect.txt 2>&1
git rev-parse c17 >../c17.txt
)sh";

class HistoryCommand : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("history");
    traces::write_synthetic_flight(*folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("run"),
                 "--record", "--quiet"});
    const ProgramResult baseline = program({"budget", "record", path("run")});
    ASSERT_EQ(baseline.status, 0) << baseline.err;
    write("baseline.json", baseline.out);
    write("all.yaml",
          "budgets:\n  - limits:\n      - { stage: frame matching, limit: cycles <= +1 % }\n"
          "      - { stage: feature extraction, limit: cycles <= +1 % }\n");
    write("matching.yaml",
          "budgets:\n  - limits:\n      - { stage: frame matching, limit: cycles <= +1 % }\n");
    fs::create_directory(*folder_ / "bin");
    fs::create_symlink(tests::program_path(), *folder_ / "bin/leviosim");
    write("story.sh", kStory);
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(*folder_ / name) << text;
  }
  static std::string text(const std::string& name) { return base::read_text_file(path(name)); }
  static void expect_holds(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
  }
  /// The lines of a text without what numbers and commits are in them.
  static std::set<std::string> shapes_of(const std::string& text) {
    std::set<std::string> shapes;
    for (const std::string& line : lines_of(text))
      shapes.insert(
          std::regex_replace(line, std::regex("\\b[0-9a-f]{40}\\b|[0-9]+([.][0-9]+)?"), "#"));
    return shapes;
  }
  static ProgramResult add(const std::string& commit, std::vector<std::string> further) {
    std::vector<std::string> words{"history",  "add",  path("run"), "--commit",    commit,
                                   "--branch", "main", "--subject", "a, \"b\" <c>"};
    words.insert(words.end(), further.begin(), further.end());
    return program(words);
  }
};

TEST_F(HistoryCommand, ThirtyCommitsTellWhoMadeWhatSlower) {
  if (std::system("git --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "git is not installed";
  const std::string line = fmt::format("cd '{}' && PATH='{}':$PATH sh story.sh >log.txt 2>&1",
                                       folder_->path().string(), path("bin"));
  ASSERT_EQ(std::system(line.c_str()), 0) << text("log.txt");  // NOLINT: the line is the test's own
  const std::string commit = text("c17.txt").substr(0, 40);

  // The commit that made it slower fails, with function and mechanism.
  expect_holds(text("check17.txt"),
               {"status 1", "NOT MET", "frame matching, ", "issue: popcount +"});
  expect_holds(text("comment.md"),
               {"### leviosim: 1 of ", "**time**", "**memory**", "**map**",
                "where: frame matching, ", "why: issue: popcount", "<details>"});

  // Thirteen commits later both are named: the step with its commit, and the drift.
  const Json json = Json::parse(text("check30.json"));
  std::map<std::string, std::string> why;
  for (const Json& f : json.at("findings"))
    if (!f.at("met").get<bool>())
      for (const Json& reason : f.at("why"))
        why[f.at("stage").get<std::string>()] += reason.get<std::string>() + '\n';
  expect_holds(why["frame matching"],
               {"step of +", "at " + short_commit(commit), "count bits one by one", "popcount"});
  expect_holds(why["feature extraction"], {"drift of +", "in 10 commits"});
  EXPECT_EQ(json.at("not_met"), 0) << "nothing became worse with the last commit";
  EXPECT_EQ(json.at("warnings"), 2);
  EXPECT_FALSE(fs::exists(path("check30.status")));

  expect_holds(text("show.txt"), {"30 runs, 11 of which changed something", "drift of +",
                                  "step of +", short_commit(commit)});
  EXPECT_EQ(testing::screen_fault(text("show.txt")), "") << text("show.txt");
  expect_holds(text("trend.html"), {"drift of +", "step of +", "count bits one by one"});
  expect_holds(text("bisect.txt"), {commit + " is the first bad commit", "verdict: skipped"});

  // A run of a history does not say what energy its stages took and which blocks they had.
  for (const char* part : {"energy of a frame by", "blocks at a peak"})
    EXPECT_EQ(text("comment.md").find(part), std::string::npos) << text("comment.md");
}

TEST_F(HistoryCommand, TheTranscriptOfThePageIsThatOfTheStory) {
  if (!fs::exists(path("bisect.txt")))
    GTEST_SKIP() << "ThirtyCommitsTellWhoMadeWhatSlower did not run";
  const std::string page = tests::read_text(tests::source_folder() / "tools/app/history/BISECT.md");
  const std::string begin = "```text\n";
  const std::size_t at = page.find(begin) + begin.size();
  const std::set<std::string> printed = shapes_of(
      std::regex_replace(text("bisect.txt"), std::regex("[.][.]/matching"), "/tmp/slower"));
  for (const std::string& line : shapes_of(page.substr(at, page.find("```", at) - at)))
    EXPECT_EQ(printed.count(line), 1u) << line << "\nis not in:\n" << text("bisect.txt");
}

TEST_F(HistoryCommand, ARunIsALineAndMergesAreUnions) {
  for (const char* n : {"1", "2"}) {
    const std::string file = path(fmt::format("part{}.jsonl", n));
    const ProgramResult first =
        add(fmt::format("abc{}", n), {"--file", file, "--time", fmt::format("100{}", n)});
    ASSERT_EQ(first.status, 0) << first.err;
  }
  const std::size_t whole = fs::file_size(path("part1.jsonl"));
  ASSERT_EQ(add("abc3", {"--file", path("part1.jsonl"), "--time", "1003"}).status, 0);
  EXPECT_LT(fs::file_size(path("part1.jsonl")) - whole, 20'000u) << text("part1.jsonl");
  std::set<std::string> lines;
  for (const char* name : {"part1.jsonl", "part2.jsonl"})
    for (const std::string& line : lines_of(text(name))) lines.insert(line);
  write("merged.jsonl", tests::joined(lines));
  const Json shown =
      Json::parse(program({"history", "show", "--file", path("merged.jsonl"), "--json"}).out);
  ASSERT_EQ(shown.at("runs").size(), 3u);
  EXPECT_EQ(shown.at("runs").at(0).at("commit"), "abc1");
  EXPECT_EQ(shown.at("runs").at(2).at("commit"), "abc3");
  EXPECT_EQ(shown.at("runs").at(0).at("figures"), shown.at("runs").at(1).at("figures"));
  // One after the other is as good, and adding a run again is no second one.
  write("joined.jsonl", text("part1.jsonl") + text("part2.jsonl") + text("part1.jsonl"));
  ASSERT_EQ(add("abc3", {"--file", path("joined.jsonl"), "--time", "1003"}).status, 0);
  EXPECT_EQ(Json::parse(program({"history", "show", "--file", path("joined.jsonl"), "--json"}).out),
            shown);
}

/// What a board counted, under the same budgets: 5 % less than the model in one stage, 10 % more in
/// another.
TEST_F(HistoryCommand, MeasuredCyclesAreComparedCheckedAndKept) {
  const Json baseline = Json::parse(text("baseline.json"));
  const auto cycles = [&](const std::string& key) {
    return baseline.at("statistics")
        .at("stages." + key + ".cycles.parallel.mean")
        .at(0)
        .get<double>();
  };
  const auto board = [&](const char* file, double matching) {
    write(file,
          fmt::format("# profile: levio\n# platform: gap9\n# counted by hand\nstage,cycles,calls\n"
                      "frame matching,{:.0f},10\nfeature_extraction,{:.0f},10\nreadout,7,1\n",
                      matching, cycles("feature_extraction") / 0.9));
    return path(file);
  };
  const std::string first = board("board.csv", cycles("frame_matching") / 1.05);
  for (const auto& [a, b] : {std::pair{path("run"), first}, std::pair{first, path("run")}}) {
    const ProgramResult compared = program({"compare", a, b});
    ASSERT_EQ(compared.status, 0) << compared.err;
    expect_holds(compared.out, {"measured: " + first, "+5.00 %", "-10.00 %",
                                "not measured: ", "no stage 'readout'",
                                "in short: 7.50 % off on average of 2 stages"});
    EXPECT_EQ(testing::screen_fault(testing::run_on_screen(folder_->path(), {"compare", a, b}).out),
              "");
  }
  const Json json = Json::parse(program({"compare", path("run"), first, "--json"}).out);
  EXPECT_EQ(json.at("model_errors").size(), json.at("stages").size() + 1);

  write(
      "board.yaml",
      "budgets:\n  - profile: levio\n    limits:\n      - { stage: \"*\", limit: cycles <= +1 % }\n"
      "      - L1 peak <= 1 kB\n");
  const auto check = [&](const std::string& run, const std::string& against) {
    return program({"check", run, "--budget", path("board.yaml"), "--baseline", against});
  };
  const ProgramResult model = check(path("run"), first);
  EXPECT_EQ(model.status, 1) << model.err;
  expect_holds(model.out, {"NOT MET  frame matching: cycles <= +1 %", "better   feature extraction",
                           "NOT MET  L1 peak", "cycles were measured, so nothing is known"});
  const ProgramResult measured = check(first, path("run"));
  EXPECT_EQ(measured.status, 1) << measured.err;
  expect_holds(measured.out, {"left out, since it was not measured: L1 peak <= 1 kB",
                              "NOT MET  feature", "better   frame matching"});

  const std::string file = path("boards.jsonl");
  const auto keep = [&](const std::string& run, const char* commit, const char* time) {
    return program({"history", "add", run, "--file", file, "--commit", commit, "--branch", "main",
                    "--time", time, "--subject", "s"});
  };
  ASSERT_EQ(keep(first, "b1", "1").status, 0);
  ASSERT_EQ(keep(path("run"), "b1", "1").status, 0);
  ASSERT_EQ(keep(board("later.csv", cycles("frame_matching")), "b2", "2").status, 0);
  const ProgramResult shown =
      program({"history", "show", "--file", file, "--budget", path("board.yaml")});
  expect_holds(shown.out, {"frame matching: cycles <= +1 %: step of +5.00 % at b2",
                           "2 runs, 1 of which changed something"});
  expect_done({"history", "page", "--file", file, "--budget", path("board.yaml"), "--out",
               path("boards.html")});

  expect_refused(check(first, path("run") + "/manifest.json"), {"manifest.json"});
  expect_refused(program({"compare", first, path("run"), "-p", "cluster.cores=4"}),
                 {"was measured"});
  expect_refused(program({"compare", first, path("run"), "--report", path("x.html")}), {"no page"});
  for (const auto& [content, fault] : {std::pair{"stage,cycels\na,1\n", "expected the titles"},
                                       std::pair{"stage,cycles\n", "no measurement"},
                                       std::pair{"stage,cycles\na,-1\n", "below zero"},
                                       std::pair{"stage,cycles\na,x\n", "column 2 (cycles)"},
                                       std::pair{"stage,cycles,calls\na,1,0\n", "below one"}}) {
    write("bad.csv", content);
    expect_refused(program({"compare", path("run"), path("bad.csv")}), {"bad.csv", fault});
  }
}

/// Baselines in version control are a history of their own.
TEST_F(HistoryCommand, BaselinesAreRunsToo) {
  const std::string file = path("baselines.jsonl");
  const auto add_of = [&](const std::string& run) {
    return program({"history", "add", run, "--file", file, "--commit", "abc", "--branch", "main",
                    "--time", "1", "--subject", "s"});
  };
  ASSERT_EQ(add_of(path("baseline.json")).status, 0);
  const ProgramResult again = add_of(path("run"));
  ASSERT_EQ(again.status, 0) << again.err;
  expect_holds(again.out, {"is in ", "already"});
  expect_refused(program({"history", "show", "--file", file, "--profile", "next"}),
                 {"no runs of next"});
}

/// A wrapper that sets a number of the chip is another build.
TEST_F(HistoryCommand, TwoProgramsAreComparedOnTheSameInput) {
  write("slower", fmt::format("#!/bin/sh\nexec '{}' \"$@\" -p isa.ops.popcount.issue=2\n",
                              path("bin/leviosim")));
  fs::permissions(path("slower"), fs::perms::owner_all);
  const auto compare = [](const std::string& one, const std::string& other) {
    return program({"compare", "--programs", one, other, "--", "--platform", "gap9", "--data",
                    path("flight"), "--frames", "0:12"});
  };
  const ProgramResult result = compare(path("bin/leviosim"), path("slower"));
  ASSERT_EQ(result.status, 0) << result.err;
  expect_holds(result.out, {path("bin/leviosim"), "isa.ops.popcount.issue=2", "the same operations",
                            "note: of +", "other work 0, cost of the same +"});
  expect_refused(compare("/bin/false", path("slower")), {"/bin/false: run ended with status 1"});
  expect_refused(program({"compare", "--programs", "a", "b"}), {"behind --"});
}

TEST_F(HistoryCommand, ExportsForOtherTrackers) {
  const std::string file = path("exported.jsonl");
  ASSERT_EQ(add("abc", {"--file", file, "--time", "1"}).status, 0);
  const Json list = Json::parse(
      program({"history", "show", "--file", file, "--export", "github-action-benchmark"}).out);
  EXPECT_GT(list.size(), 8u);
  for (const Json& entry : list) EXPECT_TRUE(entry.at("value").is_number()) << entry.dump();
  const Json map =
      Json::parse(program({"history", "show", "--file", file, "--export", "bencher"}).out);
  EXPECT_TRUE(map.at("frame on N cores").at("kcycles").at("value").is_number());
  expect_refused(program({"history", "show", "--file", file, "--export", "benchr"}),
                 {"did you mean 'bencher'"});
}

TEST_F(HistoryCommand, RefusesBadInput) {
  const std::string file = path("refused.jsonl");
  ASSERT_EQ(add("abc", {"--file", file, "--time", "1"}).status, 0);
  expect_refused(add("a b", {"--file", file, "--time", "1"}), {"--commit 'a b'"});
  expect_refused(add("abcd", {"--file", file, "--time", "noon"}), {"--time 'noon'"});
  expect_refused(program({"history", "shwo"}), {"did you mean 'show'"});
  expect_refused(program({"history", "show", "--file", path("none.jsonl")}), {"none.jsonl"});
  expect_refused(program({"history", "show", "--file", path("all.yaml")}),
                 {"all.yaml:1", "no line of a history"});
  expect_refused(program({"history", "page", "--file", file}), {"--out is missing"});
  write("cut.jsonl", text("refused.jsonl").substr(0, 5000));
  EXPECT_EQ(program({"history", "show", "--file", path("cut.jsonl")}).status, 2);
  write("old.jsonl", "{\"kept\":\"8f3c00000000\",\"what\":\"facts\",\"value\":{}}\n");
  expect_refused(program({"history", "show", "--file", path("old.jsonl")}),
                 {"old.jsonl", "earlier leviosim", "history add"});
}

TEST_F(HistoryCommand, BisectSkipsWhatDoesNotRunAndStopsForABadBudget) {
  const auto bisect = [](const std::string& run, const std::string& budget,
                         const std::string& command) {
    return program({"bisect", run, "--budget", budget, "--baseline", path("baseline.json"), "--",
                    command})
        .status;
  };
  EXPECT_EQ(bisect(path("run"), path("all.yaml"), "true"), 0);
  EXPECT_EQ(bisect(path("run"), path("all.yaml"), "false"), 125);
  EXPECT_EQ(bisect(path("run"), path("all.yaml"), path("no-such-program")), 128);
  EXPECT_EQ(bisect(path("run"), path("all.yaml"), path("all.yaml")), 128);  // not executable
  EXPECT_EQ(bisect(path("nowhere"), path("all.yaml"), "true"), 125);
  EXPECT_EQ(bisect(path("run"), path("none.yaml"), "true"), 128);
}

TEST_F(HistoryCommand, BisectNeverBlamesACommitForTheCommandLine) {
  const auto bisect = [](const std::vector<std::string>& words) {
    std::vector<std::string> all{"bisect", path("run")};
    all.insert(all.end(), words.begin(), words.end());
    return program(all);
  };
  const auto with = [&](const std::string& limits) {
    write("limits.yaml", "budgets:\n" + limits);
    return bisect({"--budget", path("limits.yaml"), "--", "true"});
  };
  EXPECT_EQ(with("  - limits: [missed <= 100 %]\n").status, 0);
  EXPECT_EQ(bisect({"--budgt", path("all.yaml"), "--", "true"}).status, 128);
  EXPECT_EQ(bisect({"--", "true"}).status, 128);
  EXPECT_EQ(bisect({"--budget"}).status, 128);
  const std::vector<std::string> usable{"--budget", path("all.yaml"), "--baseline",
                                        path("baseline.json"), "--"};
  EXPECT_EQ(bisect(usable).status, 128);
  EXPECT_EQ(bisect({"--budget", path("limits.yaml"), "--platform", "gap99", "--", "true"}).status,
            128);
  EXPECT_EQ(with("  - limits: [{ stage: no such, limit: cycles <= 1 kcycles }]\n").status, 128);
  EXPECT_EQ(with("  - limits: [no.such.statistic <= 1]\n").status, 128);
  EXPECT_EQ(with("  - { profile: none, limits: [missed <= 1 %] }\n").status, 128);
  EXPECT_EQ(with("  - { platform: none, limits: [frame cycles <= +1 %] }\n"
                 "  - limits: [missed <= 100 %]\n")
                .status,
            0);
  // Known before anything is built.
  const ProgramResult relative =
      bisect({"--budget", path("all.yaml"), "--", "touch", path("built")});
  EXPECT_EQ(relative.status, 128);
  EXPECT_NE(relative.err.find("expected --baseline"), std::string::npos) << relative.err;
  EXPECT_FALSE(fs::exists(path("built")));
}

}  // namespace
}  // namespace leviosim::tools
