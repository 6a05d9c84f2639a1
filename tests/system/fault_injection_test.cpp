// Each call of a kind fails once, in order: the first allocation of a command, the second, … until
// the command has fewer. After each, nothing of others is touched, nothing half-written stays, and
// one line says what happened. Of each kind some are tried, and all with LEVIOSIM_ALL_FAULTS=1.
// Allocations that the same functions make, with nothing changed between, count as one.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <regex>

#include "sim/outputs/file_system.h"
#include "tests/support/fault_injector.h"
#include "tests/support/paths.h"
#include "tests/support/program_suite.h"
#include "tests/support/run_program.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using tests::picture_of;
using tests::read_text;
using tests::Scratch;
using tests::write_text;
using Arguments = std::vector<std::string>;
using Picture = std::map<std::string, std::string>;

/// Sampled: every one is tried where there are few, else the first, the last and some between.
constexpr std::uint64_t kSamples = 8;

/// LEVIOSIM_ALL_FAULTS=K/M takes every M-th from the K-th on, for several processes at once.
std::vector<std::uint64_t> chosen(std::uint64_t calls) {
  std::vector<std::uint64_t> numbers;
  if (const char* const all = std::getenv("LEVIOSIM_ALL_FAULTS")) {
    std::uint64_t first = 1, step = 1;
    std::sscanf(all, "%" SCNu64 "/%" SCNu64, &first, &step);
    for (std::uint64_t number = first; number <= calls; number += step) numbers.push_back(number);
    return numbers;
  }
  const std::uint64_t tries = std::min(calls, kSamples);
  for (std::uint64_t i = 0; i < tries; ++i)
    numbers.push_back(tries == 1 ? 1 : 1 + i * (calls - 1) / (tries - 1));
  return numbers;
}

/// A command that works in a folder, as often as wanted (tests/support/fault_injector.cpp). The
/// folder has to hold the same each time.
class FaultyProgram {
 public:
  FaultyProgram(Arguments words, const fs::path& folder) {
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
    socket_ = outputs::Descriptor(ends[0]);
    const outputs::Descriptor other(ends[1]);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
    posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
    const std::string program = tests::program_path();
    words.insert(words.begin(), program);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::setenv("LD_PRELOAD", LEVIOSIM_FAULT_INJECTOR, 1);
    ::setenv("LD_BIND_NOW", "1", 1);  // once, not in each copy
    testing::AllLines environment;
    const int error =
        posix_spawn(&pid_, program.c_str(), &files, nullptr, arguments.data(), environment.data());
    for (const char* name : {"LD_PRELOAD", "LD_BIND_NOW"}) ::unsetenv(name);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) std::abort();
  }
  ~FaultyProgram() {
    socket_ = outputs::Descriptor();
    ::waitpid(pid_, nullptr, 0);
  }
  FaultyProgram(const FaultyProgram&) = delete;
  FaultyProgram& operator=(const FaultyProgram&) = delete;

  /// @returns nothing if nothing can be preloaded into the program
  std::optional<FaultAnswer> run(const std::string& kind, std::uint64_t number) const {
    const std::string request = fmt::format("{}:{}", kind, number);
    FaultAnswer answer;
    if (::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL) < 0 ||
        ::recv(socket_.get(), &answer, sizeof(answer), 0) != sizeof(answer))
      return std::nullopt;
    return answer;
  }

 private:
  outputs::Descriptor socket_;
  pid_t pid_ = -1;
};

class FaultInjection : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("faults");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--size", "32x24",
                 "--frames", "0:2", "--record", "--quiet", "--out", path("recorded")});
    write_text(path("budgets.yaml"), "budgets: [{ limits: [L1 peak <= 1 MB] }]\n");
    write_text(path("plan.yaml"),
               "base: { trace: recorded }\n"
               "points: { grid: { platform.cluster.clock: [200] } }\n");
  }

  /// What became of a command.
  struct After {
    int status = -1;
    std::string err = {};
    Picture files = {};
    std::uint64_t calls = 0;
  };
  static After after(const FaultyProgram& program, const fs::path& place, const std::string& kind,
                     std::uint64_t number) {
    const std::optional<FaultAnswer> answered = program.run(kind, number);
    EXPECT_TRUE(answered) << "the program answers no more";
    const FaultAnswer answer = answered.value_or(FaultAnswer());
    EXPECT_EQ(answer.failed, number == 0 || answer.calls < number ? 0u : 1u);
    After after{.status = WIFEXITED(answer.wait_status) ? WEXITSTATUS(answer.wait_status)
                                                        : 128 + WTERMSIG(answer.wait_status),
                .err = read_text(place / ".err"),
                .calls = answer.calls};
    for (const char* printed : {".err", ".out"}) fs::remove(place / printed);
    after.files = picture_of(place);
    return after;
  }
  /// The folder itself stays.
  static void fill(const fs::path& place, const fs::path& before) {
    for (const fs::directory_entry& entry : fs::directory_iterator(place))
      fs::remove_all(entry.path());
    fs::copy(before, place, fs::copy_options::recursive);
  }

  static void expect_orderly(const After& after, const Picture& before, const Picture& whole) {
    EXPECT_TRUE(after.status == 0 || after.status == 2 || after.status == 75) << after.status;
    const auto lines = std::count(after.err.begin(), after.err.end(), '\n');
    EXPECT_EQ(lines, after.status == 0 ? 0 : 1) << after.err;
    EXPECT_TRUE(after.status == 0 || after.err.starts_with("leviosim: ")) << after.err;
    for (const auto& [name, what] : before) {
      if (name.ends_with(".leviosim-files")) continue;
      EXPECT_EQ(after.files.count(name), 1u) << name << " is gone";
    }
    static const std::regex aside("-2(?=/|\\.|$)");
    for (const auto& [name, what] : after.files) {
      if (name.starts_with("cache") || fs::path(name).filename() == ".leviosim-files") continue;
      if (name.starts_with("sweep/points.jsonl")) continue;  // gone on with
      // What could not be given its name has another one, and is whole, too.
      const std::string own = std::regex_replace(name, aside, "");
      EXPECT_EQ(whole.count(own), 1u) << "left: " << name;
      const bool was = before.count(name) == 1 && before.at(name) == what;
      const bool is = whole.count(own) == 1 && whole.at(own) == what;
      EXPECT_TRUE(was || is || name.ends_with("manifest.json")) << "half-written: " << name;
    }
  }

  /// All faults of a kind where there was `before`; the same command given again ends well.
  static void try_all(const Arguments& words, const std::string& kind, const fs::path& before,
                      const std::string& where) {
    const Scratch place;
    fill(place.path(), before);
    const FaultyProgram faulty(words, place.path());
    const After whole = after(faulty, place.path(), kind, 0);
    ASSERT_EQ(whole.status, 0) << whole.err;
    fill(place.path(), before);
    const Picture was = picture_of(before);
    const std::vector<std::uint64_t> numbers = chosen(whole.calls);
    std::size_t tried = 0;
    for (const std::uint64_t number : numbers) {
      SCOPED_TRACE(fmt::format("{} {}: {} {} of {}", words[0], where, kind, number, whole.calls));
      const After ended = after(faulty, place.path(), kind, number);
      if (ended.calls >= number) ++tried;
      expect_orderly(ended, was, whole.files);
      if (ended.files != was && ended.files != whole.files) {
        const FaultyProgram again(words, place.path());
        const After last = after(again, place.path(), "none", 0);
        EXPECT_EQ(last.status, 0) << last.err;
      }
      if (ended.files != was) fill(place.path(), before);
    }
    // What threads allocate differs a little from start to start.
    EXPECT_GE(tried + 1 + numbers.size() / 50, numbers.size());
    std::printf("[   FAULTS ] %s %s: %s: %ld of %ld, %ld calls\n", words[0].c_str(), where.c_str(),
                kind.c_str(), static_cast<long>(tried), static_cast<long>(numbers.size()),
                static_cast<long>(whole.calls));
    std::fflush(stdout);
  }
  /// Into a new place, and where results of before are replaced; files of others are in both.
  /// @param there  other files of both
  static void try_all(const Arguments& words, const Picture& there = {}) {
    const Scratch before;
    write_text(before / "thesis.tex", "mine");
    write_text(before / "notes/a", "mine");
    for (const auto& [name, text] : there) write_text(before / name, text);
    const Scratch done;
    fill(done.path(), before.path());
    if (!FaultyProgram(words, done.path()).run("none", 0))
      GTEST_SKIP() << "nothing can be preloaded into this program";
    for (const char* printed : {".err", ".out"}) fs::remove(done / printed);
    for (const char* kind : {"write", "rename", "open", "mkdir", "close", "allocation"}) {
      try_all(words, kind, before.path(), "anew");
      try_all(words, kind, done.path(), "again");
    }
  }
};

TEST_F(FaultInjection, Run) {
  try_all({"run", "--native", "--data", path("flight"), "--size", "32x24", "--frames", "0:2",
           "--force", "--quiet", "--out", "out"});
}
TEST_F(FaultInjection, Sweep) {
  try_all(
      {"sweep", path("plan.yaml"), "--jobs", "1", "--quiet", "--cache", "cache", "--out", "sweep"});
}
TEST_F(FaultInjection, Report) { try_all({"report", path("recorded"), "--force", "-o", "r.html"}); }
TEST_F(FaultInjection, WhatIf) {
  try_all({"whatif", path("recorded"), "cluster.clock=200,300", "--force", "--quiet", "--report",
           "w.html"});
}
/// A history is whole or as before: begun, and grown by a run.
TEST_F(FaultInjection, HistoryAdd) {
  const auto words = [](const char* commit, const std::string& file) {
    return Arguments{"history", "add",      path("recorded"), "--file", file, "--commit",
                     commit,    "--branch", "main",           "--time", "1",  "--subject",
                     "s",       "--quiet"};
  };
  try_all(words("c1", "history.jsonl"));
  expect_done(words("c0", path("history.jsonl")));
  try_all(words("c1", "history.jsonl"), {{"history.jsonl", read_text(path("history.jsonl"))}});
}
TEST_F(FaultInjection, Check) {
  try_all({"check", path("recorded"), "--budget", path("budgets.yaml"), "--force", "--quiet",
           "--junit", "c.xml"});
}

}  // namespace
}  // namespace leviosim::tools
