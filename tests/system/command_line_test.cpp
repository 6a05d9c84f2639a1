// The program as users meet it: exit status and messages.
#include <elf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "sim/base/error.h"
#include "sim/outputs/output_folder.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/scratch.h"
#include "tests/traces/test_folder.h"
#include "tools/app/cli/former_commands.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_options.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::Program;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::AslFolder;
using traces::testing::TempFolder;

/// Words of a run that would work if the data did; tests then spoil one.
std::vector<std::string> run_words(const std::string& data, const std::string& out) {
  return {"run", "--platform", "gap9", "--data", data, "--size", "32x24", "--out", out};
}

class CommandLine : public ::testing::Test {
 protected:
  /// Runs the program, which must refuse with one message that contains all parts.
  void expect_refusal(const std::vector<std::string>& words,
                      const std::vector<std::string>& parts) {
    testing::expect_refused(run_program(folder_.path(), words), parts);
  }
  void expect_run_refused(const std::vector<std::string>& further,
                          const std::vector<std::string>& parts) {
    std::vector<std::string> words = run_words(data_.root().string(), out());
    words.insert(words.end(), further.begin(), further.end());
    expect_refusal(words, parts);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    expect_nothing_staged();
  }
  void expect_nothing_staged() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      EXPECT_EQ(entry.path().filename().string().find(".leviosim"), std::string::npos)
          << entry.path();
  }
  std::string out() const { return (folder_ / "out").string(); }

  TempFolder folder_;
  AslFolder data_;
};

TEST_F(CommandLine, VersionAndHelpSucceed) {
  const ProgramResult version = run_program(folder_.path(), {"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_EQ(version.out.rfind("leviosim ", 0), 0u);
  const ProgramResult help = run_program(folder_.path(), {"run", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("--platform"), std::string::npos);
}

/// A module of Python is loaded late, when little room is left for what each thread holds.
TEST_F(CommandLine, HoldsLittleForEachThread) {
  const std::string program = tests::read_text(tests::program_path());
  Elf64_Ehdr head{};
  ASSERT_GT(program.size(), sizeof(head));
  std::memcpy(&head, program.data(), sizeof(head));
  for (std::size_t i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment{};
    std::memcpy(&segment, program.data() + head.e_phoff + i * sizeof(segment), sizeof(segment));
    if (segment.p_type == PT_TLS) {
      EXPECT_LE(segment.p_memsz, 1520u);  // 1504 can be loaded with glibc 2.36, 4352 cannot
    }
  }
}

TEST_F(CommandLine, ListsPlatforms) {
  const ProgramResult result = run_program(folder_.path(), {"platforms"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.out.find("gap9"), std::string::npos);
}

TEST_F(CommandLine, ShowsAndComparesPlatforms) {
  const ProgramResult shown = run_program(
      folder_.path(), {"platforms", "show", "gap9", "-p", "cluster.workers=4", "--yaml"});
  EXPECT_EQ(shown.status, 0);
  EXPECT_NE(shown.out.find("workers: { value: 4"), std::string::npos) << shown.out.substr(0, 2000);
  const ProgramResult compared =
      run_program(folder_.path(), {"platforms", "diff", "gap9", "gap9", "-p", "cluster.workers=4"});
  EXPECT_EQ(compared.status, 0);
  EXPECT_NE(compared.out.find("cluster.workers  8 cores  4 cores"), std::string::npos)
      << compared.out;
  EXPECT_NE(compared.out.find(" 1 of "), std::string::npos) << compared.out;
  EXPECT_NE(run_program(folder_.path(), {"platforms", "diff", "gap9", "gap9"}).out.find("0 of "),
            std::string::npos);
}

TEST_F(CommandLine, RefusesPlatformsThatAreNotThere) {
  expect_refusal({"platforms", "shw", "gap9"}, {"unknown action 'shw'", "did you mean 'show'?"});
  expect_refusal({"platforms", "diff", "gap9"}, {"expected two platforms, found 1"});
  expect_refusal({"platforms", "show", "gap99"}, {"gap99", "gap9"});
  expect_refusal({"platforms", "show", "gap9", "-p", "controller.runs_on=cluster_core"},
                 {"controller.runs_on", "cluster.max_workers is 8 cores", "one core"});
}

/// One screen that says where to begin; every command stands on it.
TEST_F(CommandLine, WelcomesWhoTypesItsName) {
  const ProgramResult welcome = run_program(folder_.path(), {});
  EXPECT_EQ(welcome.status, 0) << welcome.err;
  EXPECT_EQ(welcome.err, "");
  for (const char* part : {"leviosim demo", "leviosim whatif", "Guard the figures", "doctor"})
    EXPECT_NE(welcome.out.find(part), std::string::npos) << part;
  std::istringstream lines(welcome.out);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto continued = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
    EXPECT_LE(static_cast<std::ptrdiff_t>(line.size()) -
                  std::count_if(line.begin(), line.end(), continued),
              80)
        << line;
  }
  EXPECT_LE(count, 24u);
}

TEST_F(CommandLine, SuggestsCommandsAndOptions) {
  expect_refusal({"rum"}, {"unknown command 'rum'; did you mean 'run'?"});
  expect_refusal({"run", "--plattform", "gap9"},
                 {"unknown option '--plattform'; did you mean '--platform'?"});
  expect_refusal({"run", "--outt=x"}, {"unknown option '--outt'; did you mean '--out'?"});
  expect_refusal({"synth", "flight"}, {"synth: unexpected argument 'flight'"});
  expect_refusal({"--verison"}, {"did you mean '--version'?"});
  expect_refusal({"compar"}, {"did you mean 'compare'?"});
  expect_refusal({"hepl", "run"}, {"did you mean 'help'?"});
  expect_refusal({"run", "--frames", "0:3", "--frames", "0:5"},
                 {"--frames is given more than once; expected it once"});
  expect_refusal({"run", "--seed"}, {"--seed: has no value; expected N"});
}

TEST_F(CommandLine, OptionsHaveOneNameEach) {
  const auto help = [&](const std::string& command) {
    return run_program(folder_.path(), {command, "--help"}).out;
  };
  for (const char* command : {"run", "tune", "flow"})
    EXPECT_NE(help(command).find("  --fps F"), std::string::npos) << command;
  for (const char* command : {"run", "replay"})
    EXPECT_NE(help(command).find(".pftrace"), std::string::npos) << command;
  for (const char* command : {"sensitivity", "microbench", "platforms"})
    EXPECT_EQ(help(command).find("  --out"), std::string::npos) << command;
  for (const char* command :
       {"run", "replay", "tune", "sweep", "flow", "validate", "ablate", "benchmark-flights"})
    EXPECT_NE(help(command).find("  --out DIR"), std::string::npos) << command;
  for (const char* command :
       {"tune", "sweep", "ablate", "sensitivity", "platforms", "benchmark-flights"})
    EXPECT_NE(help(command).find("  --jobs N"), std::string::npos) << command;
  fs::create_directory(folder_ / "folder");
  expect_refusal({"microbench", "--csv", (folder_ / "folder").string()}, {"--csv", "is a folder"});
}

TEST_F(CommandLine, NamesWhatDoesTheWorkOfAFormerCommand) {
  for (const FormerCommand& former : kFormerCommands)
    expect_refusal({std::string(former.name)}, {std::string(former.successor)});
}

TEST_F(CommandLine, NamesMissingOptions) {
  expect_refusal({"synth"}, {"--out is missing"});
  expect_refusal({"run", "--data"}, {"--data"});
}

TEST_F(CommandLine, SuggestsPlatformsAndTheirParameters) {
  expect_refusal({"run", "--platform", "gap7", "--data", "x", "--out", out()}, {"gap7", "gap8"});
  expect_run_refused({"-p", "cluster.fpus=2"}, {"cluster.fpus", "did you mean 'cluster.fpu"});
  expect_run_refused({"--profile", "levoi"}, {"levoi", "levio"});
  expect_run_refused({"-p", "supply.voltage=0.65V"},
                     {"cluster.clock=240MHz and controller.clock=240MHz"});
}

TEST_F(CommandLine, RefusesDataThatIsNotThere) {
  expect_refusal(run_words("/nonexistent/flight", out()), {"/nonexistent/flight"});
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  fs::create_directory(folder_ / "empty");
  expect_refusal(run_words((folder_ / "empty").string(), out()), {"looked for", "mav0/"});
  expect_nothing_staged();
}

TEST_F(CommandLine, RefusesFrameRanges) {
  for (const char* range : {"5:5", "3:1", "-1:4", "abc", "1", "1:2:3", "0:"})
    expect_run_refused({"--frames", range}, {std::string("'") + range + "'", "A:B"});
  expect_run_refused({"--frames", "0:7"}, {"0:7", "6 frames"});
}

TEST_F(CommandLine, RefusesNumbersOutOfRange) {
  for (const char* cores : {"0", "99", "-1", "four", "2.5"})
    expect_run_refused({"--cores", cores},
                       {std::string("--cores '") + cores + "': expected a whole number from 1 to"});
  expect_run_refused({"--cores", "16"}, {"from 1 to 8, the chip's cluster.workers"});
  expect_run_refused({"--cores", "8", "-p", "cluster.workers=4"},
                     {"from 1 to 4, the chip's cluster.workers"});
  expect_run_refused({"--seed", "-1"}, {"--seed '-1'"});
  expect_refusal({"synth", "--out", out(), "--duration", "0"}, {"--duration '0'"});
}

TEST_F(CommandLine, RefusesSizes) {
  const auto words = [&](const std::string& size) -> std::vector<std::string> {
    return {"run", "--native", "--data", data_.root().string(), "--size", size, "--out", out()};
  };
  for (const char* size : {"160", "x", "160x", "0x120", "160x-1", "160x120x3"})
    expect_refusal(words(size), {fmt::format("--size '{}'", size)});
  expect_refusal(words("64x48"), {"64"});  // larger than the camera's 32x24
}

/// What the help says that an option is without it may be said.
TEST_F(CommandLine, AnInitialDelayMayBe0) {
  const ProgramResult run =
      run_program(folder_.path(), {"run", "--native", "--data", data_.root().string(), "--size",
                                   "32x24", "--initial-delay", "0", "--out", out()});
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST_F(CommandLine, ANativeRunTakesNoOptionsOfAChip) {
  expect_refusal({"run", "--native", "--platform", "gap9", "--data", "x", "--out", out()},
                 {"--native", "leave out --platform"});
  expect_refusal({"run", "--native", "-p", "a=1", "--data", "x", "--out", out()},
                 {"leave out --set"});
}

TEST_F(CommandLine, NeverReplacesWhatIsNoResult) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "out/thesis.txt") << "work of years";
  for (const bool force : {false, true}) {
    std::vector<std::string> words = run_words(data_.root().string(), out());
    if (force) words.push_back("--force");
    expect_refusal(words, {"--out", "something other than results"});
    EXPECT_TRUE(fs::exists(folder_ / "out/thesis.txt"));
  }
  std::ofstream(folder_ / "file") << "x";
  expect_refusal(run_words(data_.root().string(), (folder_ / "file").string()), {"is a file"});
}

TEST_F(CommandLine, ReplacesResultsOnlyIfForced) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "out/manifest.json") << "{}";  // of an older leviosim, or of others
  std::vector<std::string> words = run_words(data_.root().string(), out());
  words.push_back("--force");
  expect_refusal(words, {"manifest.json", "no record", "by hand"});
  EXPECT_EQ(base::read_text_file(folder_ / "out/manifest.json"), "{}");
}

TEST_F(CommandLine, AnImageThatCannotBeReadLeavesNothingBehind) {
  outputs::write_file_atomically(data_.image(3), "no image");
  expect_run_refused({"--quiet"}, {data_.image(3).filename().string()});
}

TEST_F(CommandLine, AnOutFolderThatCannotBeMadeIsRefusedBeforeTheRun) {
  std::ofstream(folder_ / "file") << "x";
  expect_refusal(run_words(data_.root().string(), (folder_ / "file/out").string()), {"file/out"});
}

TEST_F(CommandLine, RefusesOptionsOfRenderedFlightsThatDoNotFit) {
  const auto synth = [&](std::vector<std::string> further) {
    std::vector<std::string> words{"synth", "--out", out()};
    words.insert(words.end(), further.begin(), further.end());
    return words;
  };
  const std::string motion = data_.root().string();
  expect_refusal(synth({"--imu", "real"}), {"--imu goes with --motion"});
  expect_refusal(synth({"--motion", motion, "--imu", "reel"}), {"'reel'", "real or simulated"});
  expect_refusal(synth({"--motion", motion, "--duration", "3"}), {"--frames A:B"});
  expect_refusal(synth({"--world", "workshop:1"}), {"--world goes with --motion"});
  expect_refusal(synth({"--motion", motion, "--world", "workshp:1"}), {"mean 'workshop'"});
  expect_refusal(synth({"--motion", motion, "--world", "workshop:1", "--seed", "2"}),
                 {"leave out --seed"});
  expect_refusal(synth({"--motion", motion, "--full-size", "--size", "16x12"}),
                 {"leave out --size"});
  expect_refusal(synth({"--motion", motion, "--motion-blur", "-1"}), {"--motion-blur '-1'"});
  expect_refusal(synth({"--motion", "/nonexistent"}), {"/nonexistent"});
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  expect_nothing_staged();
}

TEST_F(CommandLine, ARenderedFlightRunsAtItsSize) {
  const ProgramResult made =
      run_program(folder_.path(), {"synth", "--motion", data_.root().string(), "--size", "16x12",
                                   "--out", (folder_ / "flight").string()});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find(" --size 16x12"), std::string::npos) << made.out;
  expect_refusal(
      {"run", "--native", "--data", (folder_ / "flight").string(), "--size", "8x6", "--out", out()},
      {"image size 8x6", "decimated to 16x12"});
}

TEST_F(CommandLine, AnInterruptEndsTheProgramAndLeavesNothingBehind) {
  // The program is stopped as soon as its staged folder shows that it is at work.
  Program program(folder_.path(), {"synth", "--out", out()});
  const auto staged = [&] {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      if (entry.path().filename().string().find(".leviosim") != std::string::npos) return true;
    return false;
  };
  while (program.running() && !staged()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.send(SIGINT);
  EXPECT_EQ(program.wait().status, 128 + SIGINT);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  expect_nothing_staged();
}

TEST(RunOptions, ParsesSizes) {
  EXPECT_EQ(parse_size("752x480").width, 752);
  EXPECT_EQ(parse_size("752x480").height, 480);
}

TEST(FlightCache, AnExistingFlightIsUsedIfItIsWhole) {
  const TempFolder cache;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  const fs::path folder = flight_folder();
  EXPECT_EQ(folder.string().rfind(cache.path().string(), 0), 0u);
  fs::create_directories(folder / "mav0/cam0");  // put there by somebody
  EXPECT_THROW(cached_flight(ProgressLine::Style::None), InputError);
  fs::remove_all(folder);
  {
    outputs::OutputFolder drawn({.option = {}, .path = folder.string()});
    drawn.write("mav0/flight", "x");
    EXPECT_FALSE(drawn.commit());
  }
  EXPECT_EQ(cached_flight(ProgressLine::Style::None), folder);
  EXPECT_TRUE(fs::exists(folder / "mav0/flight"));
  if (before == nullptr)
    ::unsetenv("XDG_CACHE_HOME");
  else
    ::setenv("XDG_CACHE_HOME", kept.c_str(), 1);
}

TEST_F(CommandLine, DoctorSaysWhatIsThereAndWhatIsMissing) {
  const fs::path bin = folder_ / "bin", kitti = folder_ / "data/00";
  fs::create_directories(bin);
  fs::create_directories(kitti);
  for (const char* name : {"calib.txt", "times.txt"}) std::ofstream(kitti / name) << "x\n";
  std::ofstream(bin / "qemu-arm") << "#!/bin/sh\n";
  fs::permissions(bin / "qemu-arm", fs::perms::owner_all);
  const std::string path_before = std::getenv("PATH");
  ::setenv("PATH", bin.c_str(), 1);
  const std::vector<std::string> words{"doctor", folder_.path().string(), data_.root().string()};
  std::vector<std::string> as_json = words;
  as_json.push_back("--json");
  const ProgramResult document = run_program(folder_.path(), as_json);
  const ProgramResult screen = testing::run_on_screen(folder_.path(), words);
  ::setenv("PATH", path_before.c_str(), 1);
  ASSERT_EQ(document.status, 0) << document.err;
  std::map<std::string, nlohmann::json> findings;
  const nlohmann::json parsed = nlohmann::json::parse(document.out);
  for (const nlohmann::json& finding : parsed["findings"]) findings[finding["what"]] = finding;
  EXPECT_EQ(findings["qemu-arm"]["found"], true);
  EXPECT_EQ(findings["qemu-arm"]["where"], (bin / "qemu-arm").string());
  EXPECT_EQ(findings["arm-none-eabi-g++"]["found"], false);
  EXPECT_EQ(findings["arm-none-eabi-g++"]["where"], "apt-get install gcc-arm-none-eabi");
  EXPECT_EQ(findings["KITTI odometry"]["where"], kitti.string());
  EXPECT_EQ(findings["EuRoC (ASL)"]["where"], data_.root().string());
  EXPECT_NE(std::string(findings["libraries"]["where"]).find("zstd 1."), std::string::npos);
  EXPECT_EQ(testing::screen_fault(screen.out), "") << screen.out;
  EXPECT_NE(screen.out.find("apt-get install gcc-riscv64-unknown-elf"), std::string::npos);
}

TEST(ProgressLine, SaysWhenItIsDone) {
  EXPECT_EQ(time_left_text(1, 3601, 1), " · done in 1:00:00");
  EXPECT_EQ(time_left_text(50, 100, 73), " · done in 0:01:13");
  for (const auto& [done, total, seconds] :
       {std::tuple{0, 100, 5.0}, {100, 100, 5.0}, {10, 100, 0.0}})
    EXPECT_EQ(time_left_text(done, total, seconds), "");
}

TEST(ProgressLine, FrameProgressReadsAsASentence) {
  EXPECT_EQ(frame_progress(123, 300, 6'150'000'000, 3.0),
            "frame 123/300 · simulated 6.15 s · 41 frames/s · done in 0:00:04");
  EXPECT_EQ(frame_progress(300, 300, 15'000'000'000, 10.0),
            "frame 300/300 · simulated 15.00 s · 30 frames/s");
  EXPECT_EQ(frame_progress(1, 300, 0, 0), "frame 1/300 · simulated 0.00 s");
}

}  // namespace
}  // namespace leviosim::tools
