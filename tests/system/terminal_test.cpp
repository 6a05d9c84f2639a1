// What leaves the program: one line per error and no control characters, whatever names and values
// hold; bytes that are no UTF-8 from start to end; a stdout that cannot be written.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/run_program.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using testing::ProgramResult;
using testing::run_program;

/// ESC, BEL, newline, a byte that is no UTF-8, an override of the direction.
const std::string kHostile = "a\x1b[31m\x07\nleviosim: b\xff\xe2\x80\xae";

void expect_no_control(const std::string& text) {
  for (const char c : text)
    EXPECT_TRUE(c == '\n' || c == '\t' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f))
        << text;
  EXPECT_EQ(text.find("\xe2\x80\xae"), std::string::npos) << text;
  EXPECT_EQ(text.find('\xff'), std::string::npos) << text;
}

class Terminal : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / fmt::format("leviosim-{}-terminal", ::getpid());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    traces::write_synthetic_flight(folder_ / ("flight" + kHostile),
                                   {.duration_s = 1.5, .texel_m = 0.05});
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string path(const std::string& name) { return (folder_ / name).string(); }
  static std::string flight() { return path("flight" + kHostile); }

  static ProgramResult run(std::vector<std::string> words) {
    const ProgramResult result = run_program(folder_, std::move(words));
    expect_no_control(result.out);
    expect_no_control(result.err);
    return result;
  }
  /// Exit status and stderr of a shell's line, in which $L is the program.
  static std::pair<int, std::string> shell(const std::string& line) {
    const std::string script =
        fmt::format("L='{}'; exec 2>'{}'; {}", leviosim::tests::program_path(), path("err"), line);
    ::setenv("SCRIPT", script.c_str(), 1);
    const int status = std::system("bash -c \"$SCRIPT\"");  // NOLINT: the line is the test's own
    return {WEXITSTATUS(status), base::read_text_file(folder_ / "err")};
  }

  static fs::path folder_;
};
fs::path Terminal::folder_;

TEST_F(Terminal, ErrorsAreOneLineWhateverTheyName) {
  outputs::write_file_atomically(folder_ / "plan.yaml",
                                 "base: { \"x\\ny\\e[2J\": 1 }\npoints: { list: [{ seed: 1 }] }\n");
  outputs::write_file_atomically(folder_ / "est.tum", "1 2 3\x1b[2J 4 5 6 7 8\n");
  outputs::write_file_atomically(folder_ / "chip.yaml", "name: \"a\\nb\"\n\"k\\e[1m\\nq\": 3\n");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {kHostile},
           {"run", kHostile},
           {"run", "--" + kHostile},
           {"run", "--native", "--data", kHostile, "--out", path("x")},
           {"run", "--platform", kHostile, "--data", flight(), "--out", path("x")},
           {"run", "--platform", "gap9", "-p", "x" + kHostile + "=1", "--data", flight(), "--out",
            path("x")},
           {"run", "--platform", "gap9", "--cores", kHostile, "--data", flight(), "--out",
            path("x")},
           {"run", "--native", "--profile", kHostile, "--data", flight(), "--out", path("x")},
           {"platforms", "show", path("chip.yaml")},
           {"platforms", kHostile},
           {"eval", path("est.tum"), path("est.tum")},
           {"eval", kHostile, kHostile},
           {"replay", kHostile, "--out", path("x")},
           {"trace", "info", kHostile},
           {"sweep", path("plan.yaml"), "--list"},
           {"sweep", kHostile, "--list"}}) {
    const ProgramResult result = run(words);
    testing::expect_refused(result, {});
    EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
  }
}

TEST_F(Terminal, NamesThatAreNoUtf8ComeThroughEveryCommand) {
  const auto expect_done = [&](std::vector<std::string> words, const std::string& out) {
    const ProgramResult result = run(std::move(words));
    EXPECT_LE(result.status, 1) << result.err;  // 1: a limit is not met, such as of tune
    EXPECT_TRUE(fs::exists(path(out))) << result.out << result.err;
  };
  const std::string out = "out" + kHostile;
  const std::vector<std::string> cache{"--cache", path("cache")};
  expect_done({"run", "--native", "--data", flight(), "--frames", "0:8", "--out", path(out)}, out);
  const Json manifest = Json::parse(base::read_text_file(folder_ / out / "manifest.json"));
  EXPECT_NE(manifest.at("data").at("folder").get<std::string>().find("\xef\xbf\xbd"),
            std::string::npos);
  expect_done({"run", "--platform", "gap9", "--data", flight(), "--frames", "0:8", "--record",
               "--out", path("r" + out)},
              "r" + out);
  expect_done({"replay", path("r" + out), "--out", path("p" + out)}, "p" + out);
  expect_done({"trace", "info", path("r" + out) + "/work.trace"}, "r" + out);
  const std::string est = path(out) + "/trajectory.tum";
  expect_done({"eval", est, flight(), "--json", path("json" + kHostile + ".json"), "--report",
               path("html" + kHostile + ".html"), "--relative", "0.0001"},
              "json" + kHostile + ".json");
  expect_done(
      {"ablate", "--data", "name=" + flight(), "--size", "32x24", "--seed", "1", "--relative",
       "0.0001", "--cache", path("cache" + kHostile), "--out", path("a" + out)},
      "a" + out);
  expect_done({"ablate", "--data", "name=" + flight(), "--size", "32x24", "--seed", "1", "--vary",
               "paper", "--points", "1", "--relative", "0.0001", "--cache",
               path("cache" + kHostile), "--out", path("e" + out)},
              "e" + out);
  expect_done(
      {"tune", "--data", flight(), "--size", "32x24", "--clock", "300", "--fps", "10", "--ate",
       "1000", "--miss-rate", "1", "--cache", path("cache" + kHostile), "--out", path("t" + out)},
      "t" + out);
  expect_done({"flow", "--platform", "cortex-m4f", "--data", flight(), "--frames", "0:3", "--out",
               path("f" + out)},
              "f" + out);

  const fs::path beside = folder_ / ("s" + out);
  fs::create_directory(beside);
  fs::copy_file(folder_ / ("r" + out) / "work.trace", beside / "x\xff.trace");
  outputs::write_file_atomically(
      beside / "plan.yaml",
      "base: { trace: \"x\xff.trace\" }\npoints: { grid: { platform.cluster.clock: [240] } }\n");
  const ProgramResult swept = run({"sweep", (beside / "plan.yaml").string(), "--cache",
                                   path("cache" + kHostile), "--out", path("sw" + out)});
  EXPECT_TRUE(swept.status == 0 || swept.status == 2) << swept.err;  // YAML must be UTF-8
  fs::copy_file(folder_ / ("r" + out) / "work.trace", beside / "x.trace");
  outputs::write_file_atomically(
      beside / "plan.yaml",
      "base: { trace: x.trace }\npoints: { grid: { platform.cluster.clock: [240] } }\n");
  expect_done({"sweep", (beside / "plan.yaml").string(), "--cache", path("cache" + kHostile),
               "--out", path("sw" + out)},
              "sw" + out + "/sweep.csv");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    EXPECT_EQ(entry.path().filename().string().find(".partial"), std::string::npos);
}

TEST_F(Terminal, AStdoutThatCannotBeWrittenIsAFault) {
  for (const char* words :
       {"--help", "--version", "run --help", "platforms list", "platforms show gap9", "workload"}) {
    const auto [status, err] = shell(fmt::format("$L {} >/dev/full", words));
    EXPECT_EQ(status, 2) << words;
    EXPECT_EQ(err, "leviosim: stdout: cannot be written: No space left on device\n") << words;
  }
  const auto [closed, why] = shell("$L platforms list >&-");
  EXPECT_EQ(closed, 2);
  EXPECT_EQ(why, "leviosim: stdout: cannot be written: Bad file descriptor\n");
}

TEST_F(Terminal, AReaderThatHasSeenEnoughIsNone) {
  const auto [status, err] = shell("$L platforms show gap9 | true; exit ${PIPESTATUS[0]}");
  EXPECT_TRUE(status == 128 + SIGPIPE || status == 0) << status;  // 0: it was written before
  EXPECT_EQ(err, "");
  const auto [slow, text] =
      shell("(sleep 0.3; $L platforms show gap9) | true; exit ${PIPESTATUS[0]}");
  EXPECT_EQ(slow, 128 + SIGPIPE);
  EXPECT_EQ(text, "");
  const auto [ignored, message] =
      shell("trap '' PIPE; (sleep 0.3; $L platforms show gap9) | true; exit ${PIPESTATUS[0]}");
  EXPECT_EQ(ignored, 2);
  EXPECT_EQ(message, "leviosim: stdout: cannot be written: Broken pipe\n");
}

/// A check prints so little that it is written at the end only, when its limit was found not met.
TEST_F(Terminal, AReaderThatHasSeenEnoughIsNoneWhereALimitIsNotMet) {
  ASSERT_EQ(run({"run", "--platform", "gap9", "--data", flight(), "--frames", "0:8", "--quiet",
                 "--out", path("checked")})
                .status,
            0);
  outputs::write_file_atomically(folder_ / "tight.yaml",
                                 "budgets: [{ limits: [L1 peak <= 1 kB] }]\n");
  const auto [status, err] =
      shell(fmt::format("(sleep 0.3; $L check '{}' --budget '{}') | true; exit ${{PIPESTATUS[0]}}",
                        path("checked"), path("tight.yaml")));
  EXPECT_EQ(status, 128 + SIGPIPE);
  EXPECT_EQ(err, "");
}

TEST_F(Terminal, AClosedStderrStopsNothing) {
  EXPECT_EQ(shell("$L run --native --frames 0:8 --data '" + flight() + "' --out '" + path("quiet") +
                  "' 2>&-")
                .first,
            0);
  EXPECT_EQ(shell("$L run --native --data /nonexistent --out '" + path("none") + "' 2>&-").first,
            2);
}

}  // namespace
}  // namespace leviosim::tools
