// Each call of a kind fails once, in order: the first write of a command, the second, … until the
// command has fewer. After each, nothing of others is touched, nothing half-written stays, and one
// line says what happened. Of each kind some are tried, all with LEVIOSIM_ALL_FAULTS=1.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <regex>
#include <set>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::ProgramResult;
using tests::picture_of;
using tests::read_text;
using tests::Scratch;
using tests::write_text;
using Words = std::vector<std::string>;
using Picture = std::map<std::string, std::string>;

/// Sampled: every one is tried where there are few, else the first, the last and some between.
constexpr std::uint64_t kSamples = 8;

struct Counts {
  std::uint64_t calls = 0;
  std::uint64_t failed = 0;
};

class FaultInjection : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("faults");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--size", "32x24",
                 "--record", "--quiet", "--out", path("recorded")});
    write_text(path("budgets.yaml"), "budgets: [{ limits: [L1 peak <= 1 MB] }]\n");
    write_text(path("plan.yaml"),
               "base: { trace: recorded }\n"
               "points: { grid: { platform.cluster.clock: [200, 370] } }\n");
  }

  /// Where a command writes, with files of others and what leviosim wrote before.
  struct Place {
    Scratch folder;
    Scratch log;
    std::string operator/(const std::string& name) const { return (folder / name).string(); }
  };
  static std::map<std::string, Words> commands(const Place& place) {
    return {{"run",
             {"run", "--native", "--data", path("flight"), "--size", "32x24", "--frames", "0:3",
              "--force", "--quiet", "--out", place / "out"}},
            {"sweep",
             {"sweep", path("plan.yaml"), "--jobs", "1", "--quiet", "--cache", place / "cache",
              "--out", place / "sweep"}},
            {"report", {"report", path("recorded"), "--force", "-o", place / "r.html"}},
            {"check",
             {"check", path("recorded"), "--budget", path("budgets.yaml"), "--force", "--quiet",
              "--junit", place / "c.xml"}}};
  }
  static ProgramResult with_fault(const Place& place, const Words& words, const std::string& kind,
                                  std::uint64_t number, Counts& counts) {
    const fs::path file = place.log / "counts";
    write_text(file, std::string(sizeof(Counts), '\0'));
    ::setenv("LD_PRELOAD", LEVIOSIM_FAULT_INJECTOR, 1);
    ::setenv("LEVIOSIM_FAULT", fmt::format("{}:{}", kind, number).c_str(), 1);
    ::setenv("LEVIOSIM_FAULT_COUNT", file.c_str(), 1);
    const ProgramResult result = testing::run_program(place.log.path(), words);
    for (const char* name : {"LD_PRELOAD", "LEVIOSIM_FAULT", "LEVIOSIM_FAULT_COUNT"})
      ::unsetenv(name);
    std::memcpy(&counts, read_text(file).data(), sizeof(Counts));
    return result;
  }
  static std::set<std::uint64_t> chosen(std::uint64_t calls) {
    const bool all = std::getenv("LEVIOSIM_ALL_FAULTS") != nullptr;
    std::set<std::uint64_t> numbers;
    const std::uint64_t tries = all ? calls : std::min(calls, kSamples);
    for (std::uint64_t i = 0; i < tries; ++i)
      numbers.insert(tries == 1 ? 1 : 1 + i * (calls - 1) / (tries - 1));
    return numbers;
  }

  static void expect_orderly(const ProgramResult& result, const Picture& before,
                             const Picture& whole, const Picture& after, bool is_sweep) {
    EXPECT_TRUE(result.status == 0 || result.status == 2) << result.status;
    const auto lines = std::count(result.err.begin(), result.err.end(), '\n');
    EXPECT_EQ(lines, result.status == 0 ? 0 : 1) << result.err;
    EXPECT_TRUE(result.status == 0 || result.err.starts_with("leviosim: ")) << result.err;
    for (const auto& [name, what] : before)
      if (!name.ends_with(".leviosim-files")) {
        EXPECT_EQ(after.count(name), 1u) << name << " is gone";
      }
    for (const auto& [name, what] : after) {
      if (name.starts_with("cache") || fs::path(name).filename() == ".leviosim-files") continue;
      if (is_sweep && name.starts_with("sweep/sweep.sqlite")) continue;  // gone on with
      // What could not be given its name has another one, and is whole, too.
      const std::string own = std::regex_replace(name, std::regex("-2(?=/|\\.|$)"), "");
      EXPECT_EQ(whole.count(own), 1u) << "left: " << name;
      const bool was = before.count(name) == 1 && before.at(name) == what;
      const bool is = whole.count(own) == 1 && whole.at(own) == what;
      EXPECT_TRUE(was || is || name.ends_with("manifest.json")) << "half-written: " << name;
    }
  }

  void try_all(const std::string& name, const std::string& kind) {
    const auto prepare = [](const Place& place) {
      write_text(place.folder / "thesis.tex", "mine");
      write_text(place.folder / "notes/a", "mine");
    };
    // Whole results, without faults; then all calls are counted where these are replaced.
    Place first;
    prepare(first);
    Counts counts;
    if (with_fault(first, {"--version"}, kind, 0, counts).status != 0)
      GTEST_SKIP() << "nothing can be preloaded into this program";
    ASSERT_EQ(with_fault(first, commands(first).at(name), kind, 0, counts).status, 0);
    const std::uint64_t calls_when_new = counts.calls;
    const Picture whole = picture_of(first.folder.path());
    ASSERT_GT(calls_when_new, 0u);
    std::uint64_t tried = 0;
    for (const std::uint64_t number : chosen(calls_when_new)) {
      SCOPED_TRACE(fmt::format("{} {}: {} of {}", name, kind, number, calls_when_new));
      const Place place;
      prepare(place);
      const Picture before = picture_of(place.folder.path());
      const ProgramResult result =
          with_fault(place, commands(place).at(name), kind, number, counts);
      ++tried;
      expect_orderly(result, before, whole, picture_of(place.folder.path()), name == "sweep");
      // The same command again ends well, where results of before were replaced, too.
      const ProgramResult again = testing::run_program(place.log.path(), commands(place).at(name));
      EXPECT_EQ(again.status, 0) << again.err;
      for (const char* aside : {"out-2", "r-2.html", "c-2.xml"})
        fs::remove_all(place.folder / aside);
      const Picture old = picture_of(place.folder.path());
      const ProgramResult replaced =
          with_fault(place, commands(place).at(name), kind, number, counts);
      expect_orderly(replaced, old, whole, picture_of(place.folder.path()), name == "sweep");
    }
    RecordProperty(kind, fmt::format("{} of {}", tried, calls_when_new));
    std::printf("[   FAULTS ] %s: %s: %ld of %ld\n", name.c_str(), kind.c_str(),
                static_cast<long>(tried), static_cast<long>(calls_when_new));
  }
  void try_all(const std::string& name) {
    // Single allocations that fail ("site") are left out: JSON documents allocate where they are
    // destroyed, and end the program. Memory that ends for good is tried by HostileOutputs.
    for (const char* kind : {"write", "rename", "open", "mkdir", "close"})
      try_all(name, kind);
  }
};

TEST_F(FaultInjection, Run) { try_all("run"); }
TEST_F(FaultInjection, Sweep) { try_all("sweep"); }
TEST_F(FaultInjection, Report) { try_all("report"); }
TEST_F(FaultInjection, Check) { try_all("check"); }

}  // namespace
}  // namespace leviosim::tools
