// What the host grants a process: small stacks, little of addresses, memory and processor time.
// Files of any size cost no more than what they may hold.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using tests::read_text;
using tests::write_text;

class HostLimits : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("host-limits");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.3, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--size", "32x24",
                 "--record", "--quiet", "--out", path("run")});
  }
  /// @param limits  of the shell: "-s 64"
  static ProgramResult under(const std::string& limits, const std::string& words) {
    const std::string command =
        fmt::format("cd {0} && ulimit {1} && exec {2} {3} >{0}/stdout.txt 2>{0}/stderr.txt",
                    folder_->path().string(), limits, tests::program_path(), words);
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            read_text(path("stdout.txt")), read_text(path("stderr.txt"))};
  }
};

/// The limit is raised where the system allows it, else named.
TEST_F(HostLimits, SmallStacksAreRaisedOrNamed) {
  for (const char* words : {"whatif run", "replay run --quiet --force --out again",
                            "run --native --data flight --size 32x24 --quiet --force --out native",
                            "report run --force --out page.html", "compare run run --quiet"})
    for (const char* stack : {"-s 64", "-s 96", "-s 200", "-S -s 64", "-s 1024"}) {
      const ProgramResult result = under(stack, words);
      if (result.status == 2) {
        expect_refused(result, {"stack", "1024 KiB"});
      } else {
        EXPECT_EQ(result.status, 0) << words << ' ' << stack << result.err;
      }
      if (std::string_view(stack) == "-S -s 64" || std::string_view(stack) == "-s 1024") {
        EXPECT_EQ(result.status, 0) << words << ' ' << stack;
      }
    }
}

TEST_F(HostLimits, RunsReserveFewAddresses) {
  for (const char* words :
       {"run --native --data flight --size 32x24 --quiet --force --out native",
        "run --platform gap9 --data flight --size 32x24 --quiet --force --out again"}) {
    const ProgramResult result = under("-v 4000000", words);
    EXPECT_EQ(result.status, 0) << words << ' ' << result.err;
  }
}

/// 4 GiB of nothing on a disk that holds none of it.
TEST_F(HostLimits, SparseFilesAreRefusedUnread) {
  const auto sparse = [](const std::string& name) {
    fs::resize_file(path(name), std::uintmax_t{4} << 30);
  };
  const auto refused = [](const std::vector<std::string>& words, const char* file) {
    const testing::ProgramLimits limits{.cpu_seconds = 2, .data_bytes = 400'000'000};
    expect_refused(Program(folder_->path(), words, limits).wait(), {file});
  };
  const std::vector<std::string> kinds{"x.trace", "x.jsonl", "x.yaml", "x.csv", "x.json"};
  for (const std::string& name : kinds) {
    write_text(path(name), "");
    sparse(name);
  }
  for (const char* command : {"whatif", "sensitivity"})
    refused({command, path("x.trace")}, "x.trace");
  refused({"replay", path("x.trace"), "--out", path("replayed")}, "x.trace");
  refused({"trace", "check", path("x.trace")}, "x.trace");
  refused({"history", "show", "--file", path("x.jsonl")}, "x.jsonl");
  refused({"sweep", path("x.yaml"), "--out", path("sweep")}, "x.yaml");
  refused({"platforms", "show", path("x.yaml")}, "x.yaml");
  refused({"eval", path("x.csv"), path("x.csv")}, "x.csv");
  refused({"check", path("run"), "--budget", path("x.yaml")}, "x.yaml");
  write_text(path("budget.yaml"), "budgets: [{ limits: [L1 peak <= +1 kB] }]\n");
  refused({"check", path("run"), "--budget", path("budget.yaml"), "--baseline", path("x.json")},
          "x.json");
  const std::vector<std::pair<const char*, std::vector<std::string>>> readers{
      {"work.trace", {"whatif", path("copy")}},
      {"run.json", {"compare", path("copy"), path("run")}},
      {"frames.csv", {"report", path("copy"), "--out", path("page.html"), "--force"}},
      {"manifest.json", {"report", path("copy"), "--out", path("page.html"), "--force"}}};
  for (const auto& [file, words] : readers) {
    fs::remove_all(path("copy"));
    fs::copy(path("run"), path("copy"), fs::copy_options::recursive);
    sparse(std::string("copy/") + file);
    refused(words, file);
  }
}

/// A page of a long history takes what its newest runs take.
TEST_F(HostLimits, PagesOfLongHistoriesTakeLittle) {
  const std::string file = path("long.jsonl");
  expect_done({"history", "add", path("run"), "--file", file, "--commit", "c0", "--branch", "main",
               "--time", "1", "--subject", "s"});
  std::string text = read_text(file);
  const std::string begin = "{\"run\":\"c0\",\"time\":1,";
  const std::size_t at = text.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::string rest = text.substr(at + begin.size(), text.find('\n', at) - at - begin.size());
  for (int n = 1; n < 20'000; ++n)
    text += fmt::format("{{\"run\":\"c{0}\",\"time\":{0},{1}\n", n + 1, rest);
  write_text(file, text);
  const testing::ProgramLimits limits{.cpu_seconds = 5, .data_bytes = 250'000'000};
  Program program(folder_->path(), {"history", "page", "--file", file, "--out", path("trend.html")},
                  limits);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(read_text(path("trend.html")).find("c20000"), std::string::npos);
}

}  // namespace
}  // namespace leviosim::tools
