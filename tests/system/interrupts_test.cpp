// Every command ends soon after a request to stop, with the status that shells expect, and leaves
// nothing behind, wherever in its work it is.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "sim/base/interruption.h"
#include "sim/base/threads.h"
#include "tests/support/run_program.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::Program;
using testing::ProgramResult;
using testing::run_program;
using Clock = std::chrono::steady_clock;

struct Started {
  const char* what;
  std::vector<std::string> words;  ///< FLIGHT, TRACE, PLAN, TABLE, OUT and CACHE stand for files
  int latest_ms;                   ///< of the signal
};

const std::vector<Started>& commands() {
  static const std::vector<Started> all{
      {"run", {"run", "--platform", "gap9", "--data", "FLIGHT", "--out", "OUT"}, 500},
      {"native run, whole images",
       {"run", "--native", "--size", "752x480", "--data", "FLIGHT", "--out", "OUT"},
       500},
      {"synth", {"synth", "--duration", "20", "--out", "OUT"}, 2000},
      {"synth --motion",
       {"synth", "--motion", "FLIGHT", "--full-size", "--motion-blur", "20", "--out", "OUT"},
       4000},
      {"replay", {"replay", "TRACE", "--out", "OUT"}, 200},
      {"trace", {"trace", "check", "TRACE"}, 30},
      {"calibrate", {"calibrate", "--data", "FLIGHT"}, 2000},
      {"sensitivity", {"sensitivity", "--data", "FLIGHT"}, 2000},
      {"validate", {"validate", "--data", "FLIGHT", "--out", "OUT"}, 500},
      {"microbench", {"microbench"}, 100},
      {"feasibility", {"platforms", "feasibility", "--data", "FLIGHT"}, 1000},
      {"ablate", {"ablate", "--data", "FLIGHT", "--cache", "CACHE", "--out", "OUT"}, 500},
      {"benchmark-flights",
       {"benchmark-flights", "FLIGHTS.yaml", "--motions", ".", "--cache", "CACHE", "--out", "OUT"},
       500},
      {"explore",
       {"explore", "--data", "FLIGHT", "--points", "20000", "--relative", "0.1", "--cache", "CACHE",
        "--out", "OUT"},
       500},
      {"tune",
       {"tune", "--data", "FLIGHT", "--clock", "100:370:10", "--cache", "CACHE", "--out", "OUT"},
       500},
      {"flow", {"flow", "--platform", "cortex-m4f", "--data", "FLIGHT", "--out", "OUT"}, 200},
      {"eval", {"eval", "TABLE", "TABLE"}, 500},
      {"sweep --list", {"sweep", "PLAN", "--list"}, 1000},
      {"sweep", {"sweep", "PLAN", "--cache", "CACHE", "--out", "SWEEP"}, 1000},
  };
  return all;
}

class Interrupts : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / fmt::format("leviosim-{}-interrupts", ::getpid());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "work");
    traces::write_synthetic_flight(folder_ / "FLIGHT", {.duration_s = 3, .texel_m = 0.01});
    const ProgramResult recorded =
        run_program(folder_, {"run", "--platform", "gap9", "--data", path("FLIGHT"), "--record",
                              "--out", path("recorded")});
    ASSERT_EQ(recorded.status, 0) << recorded.err;
    fs::rename(folder_ / "recorded/work.trace", folder_ / "TRACE");
    outputs::write_file_atomically(
        folder_ / "PLAN",
        fmt::format("base: {{ trace: {} }}\npoints: {{ random: {{ number: 300000, over: {{ "
                    "platform.cluster.clock: {{ from: 100, to: 300 }}, "
                    "platform.cluster.dma.bytes_per_cycle: {{ from: 1, to: 16 }} }} }} }}\n",
                    path("TRACE")));
    outputs::write_file_atomically(
        folder_ / "FLIGHTS.yaml",
        "motions: [FLIGHT]\nworlds: { one: [1, 2, 3] }\npieces: [whole]\n");
    std::string table;
    for (int i = 0; i < 300'000; ++i)
      table += fmt::format("{}.{:03} {} {} 0 0 0 0 1\n", i / 100, i % 100 * 10, i * 0.001, i % 7);
    outputs::write_file_atomically(folder_ / "TABLE", table);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string path(const std::string& name) { return (folder_ / name).string(); }
  static std::vector<std::string> words(const Started& command) {
    std::vector<std::string> all = command.words;
    for (std::string& word : all) {
      if (word == "OUT" || word == "SWEEP" || word == "CACHE")
        word = path("work/" + word);
      else if (fs::exists(folder_ / word))
        word = path(word);
    }
    return all;
  }

  static fs::path folder_;
};
fs::path Interrupts::folder_;

struct Stopped {
  bool in_time = false;  ///< the program was still at work
  int status = 0;
  double seconds = 0;  ///< from the signal to the end
};

Stopped stop(const fs::path& folder, const std::vector<std::string>& words, int signal,
             std::chrono::milliseconds after) {
  Program program(folder, words);
  std::this_thread::sleep_for(after);
  Stopped stopped;
  stopped.in_time = program.running();
  const auto begin = Clock::now();
  program.send(signal);
  while (program.running() && Clock::now() - begin < std::chrono::seconds(30))
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  stopped.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  if (program.running()) program.send(SIGKILL);
  stopped.status = program.wait().status;
  return stopped;
}

TEST_F(Interrupts, EndEveryCommandSoonAndLeaveNothingBehind) {
  std::mt19937 random(5);
  for (const Started& command : commands()) {
    int stopped_at_work = 0;
    double longest = 0;
    for (int trial = 0; trial < 3; ++trial) {
      const int signal = trial % 2 == 0 ? SIGINT : SIGTERM;
      const std::chrono::milliseconds after(
          trial == 0 ? 5 : 20 + random() % static_cast<unsigned>(command.latest_ms));
      const Stopped stopped = stop(folder_, words(command), signal, after);
      for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "work"))
        EXPECT_NE(entry.path().filename().string().front(), '.')  // staged
            << command.what << " leaves " << entry.path();
      fs::remove_all(folder_ / "work");
      fs::create_directory(folder_ / "work");
      // A process that had done all and was about to vanish takes no signal any more.
      const bool was_over = stopped.status == 0 && stopped.seconds < 0.5;
      if (!stopped.in_time || was_over) continue;
      ++stopped_at_work;
      longest = std::max(longest, stopped.seconds);
      EXPECT_EQ(stopped.status, 128 + signal)
          << command.what << " after " << after.count() << " ms";
      EXPECT_LT(stopped.seconds, 5) << command.what << " after " << after.count() << " ms";
    }
    EXPECT_GT(stopped_at_work, 0) << command.what;
    RecordProperty(std::string("longest_") + command.what, fmt::format("{:.2f}", longest));
  }
}

TEST_F(Interrupts, CountWhereTheCallerIgnoresThemAndWhateverTheWork) {
  // Ignored, as shells start what runs in the background.
  const auto before = std::signal(SIGINT, SIG_IGN);
  Program program(folder_, {"calibrate", "--data", path("FLIGHT")});
  std::signal(SIGINT, before);
  while (program.running() &&
         base::read_text_file(folder_ / "stderr.txt").find("frame 12/60") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.status, 128 + SIGINT) << result.out << result.err;
  EXPECT_NE(result.err.find("the same command"), std::string::npos) << result.err;
}

TEST_F(Interrupts, HangingUpIsIgnoredWhereTheCallerIgnoresIt) {
  const auto before = std::signal(SIGHUP, SIG_IGN);  // nohup
  const Stopped stopped =
      stop(folder_, words(commands()[4]), SIGHUP, std::chrono::milliseconds(20));
  std::signal(SIGHUP, before);
  EXPECT_EQ(stopped.status, 0);
}

TEST_F(Interrupts, ReachEveryJobOfALoop) {
  sigset_t interrupt;
  sigset_t before;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  pthread_sigmask(SIG_BLOCK, &interrupt, &before);
  int jobs = 0;
  EXPECT_THROW(base::parallel_for(1000, 1,
                                  [&](std::size_t) {
                                    if (++jobs == 10) ::raise(SIGINT);
                                  }),
               Interrupted);
  EXPECT_EQ(jobs, 10);
  int signal = 0;
  sigwait(&interrupt, &signal);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_NO_THROW(throw_if_interrupted());
}

}  // namespace
}  // namespace leviosim::tools
