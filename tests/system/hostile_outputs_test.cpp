// Places of outputs that a stranger prepared, and systems that refuse: nothing of others is lost or
// written to, nobody waits without end, and nothing half-written stays.
#include <gtest/gtest.h>
#include <sys/file.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "sim/outputs/output_record.h"
#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramResult;
using tests::picture_of;
using tests::read_text;
using tests::Scratch;
using tests::write_text;
using Arguments = std::vector<std::string>;

class HostileOutputs : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile-outputs");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done(run(path("ready")));
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--size", "32x24",
                 "--record", "--quiet", "--out", path("recorded")});
    write_text(path("budgets.yaml"), "budgets: [{ limits: [L1 peak <= 1 MB] }]\n");
    write_text(path("plan.yaml"),
               "base: { trace: recorded }\n"
               "points: { grid: { platform.cluster.clock: [200, 370] } }\n");
  }
  static Arguments run(const std::string& out, const Arguments& further = {}) {
    Arguments words{"run",     "--native", "--data", path("flight"), "--size", "32x24",
                    "--quiet", "--out",    out};
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }
  Arguments report(const std::string& file) const {
    return {"report", path("ready"), "-o", place(file)};
  }
  std::string place(const std::string& name) const { return (place_ / name).string(); }
  /// Refused, and nothing is changed, left or gone.
  void expect_kept(const Arguments& words, const std::vector<std::string>& parts) const {
    const auto before = picture_of(place_.path());
    expect_refused(program(words), parts);
    EXPECT_EQ(picture_of(place_.path()), before);
  }
  /// Words of commands with outputs in the place.
  std::vector<Arguments> commands() const {
    return {
        run(place("out")),
        {"sweep", path("plan.yaml"), "--quiet", "--cache", place("cache"), "--out", place("sweep")},
        report("r.html"),
        {"check", path("recorded"), "--budget", path("budgets.yaml"), "--quiet", "--junit",
         place("c.xml")}};
  }
  /// In a shell, behind other words of it.
  ProgramResult in_shell(const std::string& before, const Arguments& words) const {
    std::string line = before + " '" + tests::program_path() + "'";
    for (const std::string& word : words) line += " '" + word + "'";
    line += fmt::format(" >'{}/out' 2>'{}/err'", log_.path().string(), log_.path().string());
    const int status = std::system(line.c_str());  // NOLINT: the test's own
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            read_text(log_ / "out"), read_text(log_ / "err")};
  }
  /// One line says what went wrong, and nothing unfinished stays.
  void expect_orderly(const ProgramResult& result, const std::string& when) const {
    SCOPED_TRACE(when);
    EXPECT_TRUE(result.status == 0 || result.status == 2) << result.status << ' ' << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), result.status == 0 ? 0 : 1)
        << result.err;
    for (const auto& [name, what] : picture_of(place_.path())) {
      const std::string file = fs::path(name).filename().string();
      EXPECT_TRUE(file == ".leviosim-files" || file.front() != '.') << name;
      EXPECT_FALSE(file.ends_with("-journal")) << name;
    }
    EXPECT_TRUE(result.status != 2 || !fs::exists(place_ / "out"));
  }
  void empty_place() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(place_.path()))
      fs::remove_all(entry.path());
  }

  Scratch place_;
  Scratch log_;
};

TEST_F(HostileOutputs, JournalsProveNothing) {
  for (const char* folder : {"out", ".out.leviosim"})
    for (const char* header : {"leviosim journal 1 9", "leviosim files 1"}) {
      write_text(place_ / folder / "notes.md", "mine");
      write_text(place_ / folder / ".leviosim-files", std::string(header) + "\n- - notes.md\n");
      expect_kept(run(place("out"), {"--force"}), {});
      fs::remove_all(place_ / folder);
    }
}

TEST_F(HostileOutputs, RecordsOfOtherNamesAreNotWritten) {
  write_text(place_ / "mine", "leviosim files 1\n" + std::string(64, 'a') + " 1 x\n");
  for (const char* folder : {".out.leviosim", "sweep", ""}) {
    fs::create_directory(place_ / folder);
    fs::create_hard_link(place_ / "mine", place_ / folder / ".leviosim-files");
    for (const Arguments& words : commands())
      if (std::string(folder).empty()
              ? words[0] == "report" || words[0] == "check"
              : words.back().ends_with(fs::path(folder).stem().string().substr(*folder == '.')))
        expect_kept(words, {".leviosim-files", "one name"});
    fs::remove(place_ / folder / ".leviosim-files");
  }
}

/// What schedulers try again on.
constexpr int kTryAgain = 75;

TEST_F(HostileOutputs, LocksOfOthersEndInAMessageOrASignal) {
  write_text(place_ / ".leviosim-files", "leviosim files 1\n");
  const outputs::Descriptor held(::open(place(".leviosim-files").c_str(), O_RDWR));
  ASSERT_EQ(::flock(held.get(), LOCK_EX), 0);
  for (const int signal : {0, SIGINT, SIGTERM}) {
    Program program(log_.path(), report("r.html"));
    if (signal != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      program.send(signal);
    }
    for (int tries = 0; tries < 1500 && program.running(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(program.running()) << "waits without end";
    if (program.running()) program.send(SIGKILL);
    const ProgramResult result = program.wait();
    if (signal == 0)
      expect_refused(result, {".leviosim-files", "another process holds it"}, kTryAgain);
    else
      EXPECT_EQ(result.status, 128 + signal);
    EXPECT_EQ(picture_of(place_.path()).size(), 1u);
  }
}

TEST_F(HostileOutputs, HugeFilesOfARecordAreNotWaitedFor) {
  const auto name_file_of = [&](std::uint64_t size) {
    write_text(place_ / "out/big", "");
    fs::resize_file(place_ / "out/big", size);  // sparse
    write_text(place_ / "out/.leviosim-files",
               outputs::OutputRecord::header() +
                   outputs::OutputRecord::line("big", {std::string(64, 'a'), size}));
  };
  for (const int signal : {0, SIGINT, SIGTERM}) {
    name_file_of(signal == 0 ? 100'000'000'000 : std::uint64_t{4} << 30);
    Program program(log_.path(), run(place("out"), {"--force"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    if (signal != 0) program.send(signal);
    for (int tries = 0; tries < 500 && program.running(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(program.running()) << "hashes without end";
    if (program.running()) program.send(SIGKILL);
    const ProgramResult result = program.wait();
    if (signal == 0) {
      expect_refused(result, {"big"});
    } else {
      EXPECT_EQ(result.status, 128 + signal);
      EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    }
    EXPECT_TRUE(fs::exists(place_ / "out/big"));
  }
}

/// Long ones are not read, and of short lines no more than a flight has files.
TEST_F(HostileOutputs, RecordsOfManyLinesTakeLittle) {
  const std::string line = outputs::OutputRecord::line("some/file/of/a/flight.png", {});
  for (const auto& [megabytes, words] :
       {std::pair{std::size_t{16}, report("out/r.html")},
        std::pair{std::size_t{60}, run(place("out"), {"--force"})}}) {
    std::string record = outputs::OutputRecord::header();
    while (record.size() + line.size() < megabytes << 20) record += line;
    write_text(place_ / "out/.leviosim-files", record);
    const ProgramResult result =
        Program(log_.path(), words, {.cpu_seconds = 2, .data_bytes = 300'000'000}).wait();
    expect_refused(result, {".leviosim-files"});
    EXPECT_TRUE(read_text(place_ / "out/.leviosim-files") == record);
  }
}

TEST_F(HostileOutputs, ALimitOfFileSizesIsAFullDisk) {
  for (const int kib : {1, 4, 16, 40, 100, 200, 400})
    for (const Arguments& words : commands()) {
      expect_orderly(in_shell(fmt::format("ulimit -f {};", kib), words),
                     fmt::format("{} with {} KiB", words[0], kib));
      empty_place();
    }
}

TEST_F(HostileOutputs, MemoryThatEndsIsOneLine) {
  int refused = 0;
  for (int mib = 100; mib < 400; mib += 10)
    for (const Arguments& words : commands()) {
      const std::string limit = fmt::format("ulimit -v {};", mib * 1024);
      if (in_shell(limit, {"--version"}).status != 0) continue;  // libraries alone take more
      const ProgramResult result = in_shell(limit, words);
      expect_orderly(result, fmt::format("{} with {} MiB", words[0], mib));
      refused += result.status == 2 ? 1 : 0;
      empty_place();
    }
  EXPECT_GT(refused, 0);
}

TEST_F(HostileOutputs, NoProcIsNeeded) {
  for (const Arguments& words : commands()) {
    const ProgramResult result = in_shell(
        "unshare -m true 2>/dev/null || exit 77; exec unshare -m sh -c 'mount -t tmpfs none "
        "/proc && exec \"$@\"' sh",
        words);
    if (result.status == 77) GTEST_SKIP() << "no name space of its own can be made here";
    EXPECT_EQ(result.status, 0) << words[0] << result.err;
  }
}

}  // namespace
}  // namespace leviosim::tools
