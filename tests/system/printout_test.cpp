// What commands print: the summary of a run on a screen of its size, tables by name, colours on a
// terminal only, and JSON from every command with results.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "sim/outputs/file_system.h"
#include "tests/support/run_program.h"
#include "tools/app/cli/screen.h"
#include "tools/app/record/record.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::ProgramResult;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class PrintoutTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / fmt::format("leviosim-{}-printout", ::getpid());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    traces::write_synthetic_flight(path("flight"), {.duration_s = 1.5, .texel_m = 0.05});
    recorded_ = run({"run", "--platform", "gap9", "--data", path("flight"), "--record", "--quiet",
                     "--out", path("run")});
    ASSERT_EQ(recorded_.status, 0) << recorded_.err;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string path(const std::string& name) { return (folder_ / name).string(); }
  static ProgramResult run(std::vector<std::string> words) {
    return testing::run_program(folder_, std::move(words));
  }
  static ProgramResult replay(const std::string& out, std::vector<std::string> further) {
    std::vector<std::string> words{"replay", path("run"), "--quiet", "--out", path(out)};
    words.insert(words.end(), further.begin(), further.end());
    return run(std::move(words));
  }
  /// Exit status and output of a shell's line, in which $L is the program. What ends in `script`
  /// is a terminal of 70 columns.
  static std::string on_terminal(const std::string& line) {
    const std::string words = fmt::format("stty cols 70; {}", line);
    ::setenv("L", leviosim::tests::program_path().c_str(), 1);
    ::setenv("WORDS", words.c_str(), 1);
    const std::string command =
        fmt::format("script -qec \"bash -c '$WORDS'\" /dev/null >'{}' </dev/null", path("typed"));
    EXPECT_EQ(std::system(command.c_str()), 0) << command;  // NOLINT: the line is the test's own
    return base::read_text_file(folder_ / "typed");
  }

  static fs::path folder_;
  static ProgramResult recorded_;
};
fs::path PrintoutTest::folder_;
ProgramResult PrintoutTest::recorded_;

TEST_F(PrintoutTest, ARunFitsAScreenOf24LinesOf80Columns) {
  const std::vector<std::string> lines = lines_of(recorded_.out);
  EXPECT_LE(lines.size(), 24u) << recorded_.out;
  for (const std::string& line : lines)
    EXPECT_TRUE(line.starts_with("results: ") || display_width(line) <= 80) << line;
  for (const char* part :
       {"verdict: fits: all 30 frames", "feature extraction", "frame time: mean ", "memory: L1 ",
        "energy: ", "trajectory: ", "--tables all"})
    EXPECT_NE(recorded_.out.find(part), std::string::npos) << part << " is not in:\n"
                                                           << recorded_.out;
  EXPECT_EQ(recorded_.out.find("… 0 more"), std::string::npos) << recorded_.out;
  EXPECT_NE(recorded_.out.find("results: " + path("run") + '\n'), std::string::npos);
  EXPECT_EQ(lines.back(), "next: leviosim whatif " + path("run"));
}

/// What a stranger tries in five minutes, beside the first screen and the demonstration
/// (command_line_test.cpp, demo_command_test.cpp).
TEST_F(PrintoutTest, AnswersComeFirstAndFitAScreen) {
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"whatif", path("run")},
                                             {"whatif", path("run"), "cluster.l1.size=48,64,96KiB"},
                                             {"why", path("run")}}) {
    std::vector<std::string> quiet = words;
    quiet.push_back("--quiet");
    const ProgramResult result = testing::run_on_screen(folder_, std::move(quiet));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(result.out.starts_with("in short: ")) << result.out;
    const std::vector<std::string> lines = lines_of(result.out);
    EXPECT_LE(lines.size(), 24u) << result.out;
    for (const std::string& line : lines)
      EXPECT_TRUE(line.find(folder_.string()) != std::string::npos || display_width(line) <= 80)
          << line;
  }
}

TEST_F(PrintoutTest, WhatToTryNextIsTypedAsItStands) {
  ::setenv("L", leviosim::tests::program_path().c_str(), 1);
  ::setenv("IN", folder_.c_str(), 1);
  const std::string last = lines_of(replay("it's mine", {}).out).back();
  const std::string begin = "next: leviosim ";
  ASSERT_TRUE(last.starts_with(begin)) << last;
  const std::string line = "cd $IN && $L " + last.substr(begin.size()) + " >pasted";
  EXPECT_EQ(std::system(line.c_str()), 0) << line;  // NOLINT: the line is the program's
  EXPECT_EQ(lines_of(run({"platforms", "diff", "gap9", "gap8"}).out).back(),
            begin + "platforms stages gap9 gap8");
}

/// Every run that a test makes through the program is held to this.
TEST_F(PrintoutTest, AGreenVerdictOverAWrongMapOrALatePoseIsAFault) {
  fs::create_directories(path("verdicts"));
  const auto fault = [&](Grade map, double error_m, double path_m, int latency_ms) {
    RunRecord record;
    record.verdicts.list = {
        {"time", Grade::good, {}}, {"memory", Grade::good, {}}, {"map", map, {}}};
    record.statistics = {{.name = "run.frame_period", .unit = "ns", .value = 50e6},
                         {.name = "accuracy.ate.rmse", .unit = "m", .value = error_m},
                         {.name = "accuracy.truth_length", .unit = "m", .value = path_m}};
    outputs::write_file_atomically(folder_ / "verdicts" / "run.json", record_text(record));
    outputs::write_file_atomically(folder_ / "verdicts" / "frames.csv",
                                   fmt::format("frame,latency_ns,end_ns\n0,1000000,7\n1,{}000000,"
                                               "900000000\n2,1000000,9\n",
                                               latency_ms));
    return testing::verdict_fault(path("verdicts"));
  };
  EXPECT_EQ(fault(Grade::good, 0.9, 10, 99), "");
  EXPECT_EQ(fault(Grade::good, 1.1, 10, 49), "green over an error of 11.0 % of the path");
  EXPECT_EQ(fault(Grade::doubtful, 1.1, 10, 49), "");
  EXPECT_EQ(fault(Grade::good, 0.9, 0.9, 49), "") << "a path too short to tell";
  EXPECT_EQ(fault(Grade::good, 0.9, 10, 101), "green over a pose 2.0 periods after its image");
  EXPECT_EQ(fault(Grade::unknown, 0.9, 10, 101), "");
}

TEST_F(PrintoutTest, ARunWithoutOptionsTakesTheChipAndNamesANewFolder) {
  ::setenv("L", leviosim::tests::program_path().c_str(), 1);
  ::setenv("IN", folder_.c_str(), 1);
  const std::string run = "$L run --data flight --frames 0:3 --quiet";
  const std::string line = "cd $IN && " + run + " >first && " + run + " >second";
  ASSERT_EQ(std::system(line.c_str()), 0) << line;  // NOLINT: the line is the test's own
  EXPECT_NE(read_text_file(folder_ / "first").find("results: leviosim-run\n"), std::string::npos);
  EXPECT_NE(read_text_file(folder_ / "second").find("results: leviosim-run-2\n"),
            std::string::npos);
  EXPECT_NE(read_text_file(folder_ / "first").find("levio on gap9"), std::string::npos);
}

TEST_F(PrintoutTest, TablesAreChosenByName) {
  const ProgramResult all = replay("all", {"--tables", "all"});
  for (const char* part : {"where the core-cycles go", "pose from", "blocks alive at the peak",
                           "where the power goes", "the same cycles at the ends", "per frame "})
    EXPECT_NE(all.out.find(part), std::string::npos) << part << " is not in:\n" << all.out;
  const ProgramResult two = replay("two", {"--tables", "memory,latency"});
  EXPECT_NE(two.out.find("pose from"), std::string::npos) << two.out;
  EXPECT_EQ(two.out.find("where the core-cycles go"), std::string::npos) << two.out;
  testing::expect_refused(replay("none", {"--tables", "latancy"}),
                          {"--tables", "latancy", "did you mean 'latency'?"});
  testing::expect_refused(replay("none", {"--tables", "latency", "--json"}), {"--json"});
  testing::expect_refused(replay("none", {"--budget", "x", "--json"}), {"--json and --budget"});
  EXPECT_FALSE(fs::exists(path("none")));
}

/// Every command that prints tables prints them within the terminal, and all of them elsewhere.
TEST_F(PrintoutTest, TablesFitTheTerminal) {
  const std::string run_folder = path("run"), flight = path("flight");
  outputs::write_file_atomically(folder_ / "tables.yaml",
                                 "base: { trace: run }\n"
                                 "points: { grid: { platform.cluster.clock: [200MHz, 240MHz],\n"
                                 "  platform.controller.clock: [200MHz],\n"
                                 "  platform.cluster.dma.bytes_per_cycle: [4] } }\n");
  outputs::write_file_atomically(folder_ / "tables-flights.yaml",
                                 "motions: [flight]\nworlds: { one: [1] }\npieces: [whole]\n"
                                 "size: 32x24\nseeds: [1]\n");
  outputs::write_file_atomically(folder_ / "tables-budgets.yaml",
                                 "budgets:\n  - limits: [frame latency p99 <= 1 ms]\n");
  const std::string few =
      fmt::format(" --data {} --frames 0:30 --seed 1 --quiet --cache {}", flight, path("cache"));
  const std::string chip = fmt::format(" --data {} --frames 0:8 --quiet", flight);
  for (const std::string& words :
       {fmt::format("replay {} --quiet --force --out {} --tables all", run_folder, path("shown")),
        fmt::format("eval {0}/trajectory.tum {1} --relative 0.0001", run_folder, flight),
        fmt::format("eval {0}/trajectory.tum {1} --relative 0.0001 --also {0}", run_folder, flight),
        fmt::format("compare {0} {0}", run_folder),
        fmt::format("check {} --budget {}", run_folder, path("tables-budgets.yaml")),
        fmt::format("trace info {}/work.trace", run_folder),
        std::string("workload"),
        std::string("microbench"),
        std::string("platforms diff gap8 gap9"),
        "platforms feasibility gap8 gap9" + chip,
        "platforms stages gap9 gap9-eigen" + chip,
        "platforms systems" + chip,
        "validate --all" + chip,
        "sensitivity --all" + chip,
        fmt::format("flow --platform gap8 --data {} --quiet --force --out {}", flight,
                    path("shown-flow")),
        fmt::format("sweep {} --quiet --cache {} --out {} --budget {}", path("tables.yaml"),
                    path("cache"), path("shown-sweep"), path("tables-budgets.yaml")),
        fmt::format("tune{} --clock 200,300 --fps 10 --ate 1000 --miss-rate 1", few),
        fmt::format("ablate{} --size 32x24 --relative 0.0001 --force --out {}", few,
                    path("shown-ablate")),
        fmt::format(
            "ablate{} --size 32x24 --vary paper --points 1 --relative 0.0001 --force --out {}", few,
            path("shown-varied")),
        fmt::format("benchmark-flights {} --motions {} --quiet --cache {} --force --out {}",
                    path("tables-flights.yaml"), folder_.string(), path("cache"),
                    path("shown-flights"))}) {
    const std::vector<std::string> lines =
        lines_of(on_terminal(fmt::format("$L {} || [ $? = 1 ]", words)));  // 1: a limit is not met
    int tables = 0;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      if (!lines[i].starts_with("─")) continue;
      ++tables;
      for (std::size_t row = i - 1; row <= i; ++row)  // with the terminal's carriage return
        EXPECT_LE(display_width(lines[row]), 71) << words << ":\n" << lines[row];
    }
    EXPECT_GT(tables, 0) << words;
  }
  std::string wide;
  for (const std::string& line : lines_of(run({"microbench"}).out))
    if (line.starts_with("─") && line.size() > wide.size()) wide = line;
  EXPECT_GT(display_width(wide), 80) << "not a terminal";
}

/// Every command that prints results prints a document that says what it is, and nothing else.
TEST_F(PrintoutTest, JsonIsADocumentOnStdout) {
  const ProgramResult replayed = replay("json", {"--json"});
  EXPECT_EQ(replayed.out, base::read_text_file(folder_ / "json/run.json"));
  const std::string est = path("run/trajectory.tum"), flight = path("flight");
  const std::vector<std::string> few{"--frames",    "0:30",   "--quiet", "--cache",
                                     path("cache"), "--seed", "1"};
  const auto with_few = [&](std::vector<std::string> words) {
    words.insert(words.end(), few.begin(), few.end());
    return words;
  };
  outputs::write_file_atomically(
      folder_ / "plan.yaml",
      "base: { trace: run }\npoints: { grid: { platform.cluster.clock: [200, 240] } }\n");
  outputs::write_file_atomically(folder_ / "flights.yaml",
                                 "motions: [flight]\nworlds: { one: [1] }\npieces: [whole]\n"
                                 "size: 32x24\nseeds: [1]\n");
  const std::vector<std::vector<std::string>> commands{
      {"run", "--native", "--data", flight, "--quiet", "--out", path("native")},
      {"eval", est, flight},
      {"compare", path("run"), path("json")},
      {"trace", "info", path("run/work.trace")},
      {"trace", "check", path("run/work.trace")},
      {"workload", "--profile", "next"},
      {"platforms"},
      {"platforms", "show", "gap9"},
      {"platforms", "diff", "gap8", "gap9"},
      {"platforms", "feasibility", "gap9", "--data", flight, "--frames", "0:8", "--quiet"},
      {"platforms", "stages", "gap9", "--data", flight, "--frames", "0:8", "--quiet"},
      {"flow", "--platform", "gap8", "--data", flight, "--quiet", "--out", path("flow")},
      {"validate", "--data", flight, "--quiet"},
      {"microbench"},
      {"sweep", path("plan.yaml"), "--quiet", "--cache", path("cache"), "--out", path("sweep")},
      with_few({"tune", "--data", flight, "--clock", "300", "--fps", "10", "--ate", "1000",
                "--miss-rate", "1"}),
      with_few({"ablate", "--data", flight, "--size", "32x24", "--relative", "0.0001", "--out",
                path("ablate")}),
      with_few({"ablate", "--data", flight, "--size", "32x24", "--vary", "paper", "--points", "1",
                "--relative", "0.0001", "--out", path("varied")}),
      {"benchmark-flights", path("flights.yaml"), "--motions", folder_.string(), "--quiet",
       "--cache", path("cache"), "--out", path("flown")},
  };
  for (std::vector<std::string> words : commands) {
    words.emplace_back("--json");
    const ProgramResult result = run(words);
    EXPECT_LE(result.status, 1) << words[0] << ": " << result.err;  // 1: a limit is not met
    const Json document = Json::parse(result.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << words[0] << " printed:\n" << result.out;
    EXPECT_TRUE(document.value("format", "").starts_with("leviosim ")) << words[0];
    EXPECT_GE(document.value("version", 0), 1) << words[0];
  }
}

TEST_F(PrintoutTest, JsonOfRowsHoldsTheNumbersOfTheFile) {
  const ProgramResult listed = run({"platforms", "--json"});
  const Json chips = Json::parse(listed.out);
  EXPECT_EQ(chips.at("rows").at(0).size(), 2u);
  const ProgramResult flown = run({"flow", "--platform", "gap8", "--data", path("flight"),
                                   "--quiet", "--out", path("flow2"), "--json"});
  const Json rows = Json::parse(flown.out).at("rows");
  EXPECT_EQ(rows.size() + 1, lines_of(base::read_text_file(folder_ / "flow2/flow.csv")).size());
}

TEST(Colours, AreForVerdictsAndWarnings) {
  EXPECT_EQ(coloured_lines("a\nverdict: fits: x\nverdict: too slow\nwarning: y\n"),
            "a\n\x1b[32mverdict: fits: x\x1b[0m\n\x1b[31mverdict: too slow\x1b[0m\n"
            "\x1b[33mwarning: y\x1b[0m\n");
  // What nobody judged is not green, also where the line is broken before it.
  EXPECT_EQ(coloured_lines("verdict: fits: x,\n  map not judged: y\n"),
            "\x1b[33mverdict: fits: x,\x1b[0m\n  map not judged: y\n");
  EXPECT_EQ(coloured_lines("verdict: fits: x\nmap not judged\n"),
            "\x1b[32mverdict: fits: x\x1b[0m\nmap not judged\n");
  EXPECT_EQ(coloured_lines("no warning: y"), "no warning: y");
  EXPECT_EQ(coloured_lines(""), "");
}

TEST_F(PrintoutTest, ColoursAndWidthAreThoseOfTheTerminal) {
  const std::string words =
      fmt::format("$L replay {} --quiet --force --out {}", path("run"), path("coloured"));
  EXPECT_EQ(recorded_.out.find('\x1b'), std::string::npos);
  const std::string coloured = on_terminal("TERM=xterm " + words);
  EXPECT_NE(coloured.find("\x1b[33mverdict: fits"), std::string::npos) << coloured;
  for (const std::string& line : lines_of(coloured))  // with the terminal's carriage return
    EXPECT_TRUE(!line.starts_with("─") || display_width(line) <= 71) << line;
  EXPECT_EQ(on_terminal("NO_COLOR=1 TERM=xterm " + words).find("\x1b[32m"), std::string::npos);
  EXPECT_EQ(on_terminal("TERM=dumb " + words).find("\x1b[32m"), std::string::npos);
  EXPECT_NE(on_terminal("COLUMNS=150 TERM=xterm " + words).find("worst ms"), std::string::npos);
}

TEST_F(PrintoutTest, TheHeadingSaysWhatWasSetOfTheChip) {
  for (const ProgramResult& result :
       {replay("set-replay", {"-p", "cluster.fpu.units=1"}),
        run({"run", "--data", path("flight"), "--frames", "0:2", "-p", "cluster.fpu.units=1",
             "--quiet", "--out", path("set-run")})})
    EXPECT_NE(result.out.find("cluster.fpu.units=1,"), std::string::npos) << result.out;
}

TEST_F(PrintoutTest, SeveralSeedsAndBagsAreRefusedWithWhatToDo) {
  testing::expect_refused(
      run({"run", "--data", path("flight"), "--seed", "1,2,3", "--out", path("seeds")}),
      {"--seed '1,2,3'", "one seed", "sweep", "seed: [1,2,3]"});
  outputs::write_file_atomically(folder_ / "flight.bag", "#ROSBAG V2.0\n");
  testing::expect_refused(run({"run", "--data", path("flight.bag"), "--out", path("bag")}),
                          {"flight.bag", "ROS bag", "rosbag_to_asl.py"});
}

/// Not the folder of the cache that holds it.
TEST_F(PrintoutTest, TheSyntheticFlightIsCalledSo) {
  ASSERT_EQ(run({"run", "--data", "synthetic", "--frames", "0:2", "--quiet", "--out", path("made"),
                 "--report", path("made.html")})
                .status,
            0);
  const Json manifest = Json::parse(read_text_file(folder_ / "made/manifest.json"));
  EXPECT_EQ(manifest.at("data").at("folder"), "synthetic");
  EXPECT_NE(read_text_file(folder_ / "made.html").find("\"data\":\"synthetic\""),
            std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
