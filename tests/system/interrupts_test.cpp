// Every command ends soon after a request to stop, with the status that shells expect, and leaves
// nothing behind, wherever in its work it is.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <random>
#include <regex>
#include <thread>

#include "sim/base/interruption.h"
#include "sim/base/threads.h"
#include "tests/support/run_program.h"
#include "tests/support/scratch.h"
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
  std::vector<std::string> words;  ///< those in capitals stand for files
  int latest_ms;                   ///< of the signal
  int undisturbed = 0;             ///< the exit status without one
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
      {"validate --fit", {"validate", "--fit", "--data", "FLIGHT"}, 2000},
      {"sensitivity", {"sensitivity", "--data", "FLIGHT", "--frames", "0:60"}, 2000},
      // Values of the paper that such a short flight misses.
      {"validate", {"validate", "--data", "FLIGHT", "--out", "OUT"}, 500, 1},
      {"microbench", {"microbench"}, 100},
      {"feasibility", {"platforms", "feasibility", "--data", "FLIGHT"}, 1000},
      {"ablate", {"ablate", "--data", "FLIGHT", "--cache", "CACHE", "--out", "OUT"}, 500},
      {"benchmark-flights",
       {"benchmark-flights", "FLIGHTS.yaml", "--motions", ".", "--cache", "CACHE", "--out", "OUT"},
       500},
      {"ablate --vary",
       {"ablate", "--data", "FLIGHT", "--vary", "paper", "--points", "20000", "--relative", "0.1",
        "--cache", "CACHE", "--out", "OUT"},
       500},
      {"tune",
       {"tune", "--data", "FLIGHT", "--clock", "100:370:10", "--cache", "CACHE", "--out", "OUT"},
       500},
      {"flow", {"flow", "--platform", "cortex-m4f", "--data", "FLIGHT", "--out", "OUT"}, 200},
      {"eval", {"eval", "TABLE", "TABLE"}, 500},
      {"sweep --list", {"sweep", "PLAN", "--list"}, 1000},
      {"sweep", {"sweep", "PLAN", "--cache", "CACHE", "--out", "SWEEP"}, 1000},
      {"whatif", {"whatif", "TRACE"}, 300},
      // Files that a stranger made so that they take long.
      {"run of pictures of many scans",
       {"run", "--native", "--data", "SCANS", "--size", "160x120", "--out", "OUT"},
       500},
      {"report of many frames", {"report", "LONG", "--out", "OUT"}, 300},
      {"history show", {"history", "show", "--file", "HISTORY", "--json"}, 50},
      {"history page", {"history", "page", "--file", "HISTORY", "--out", "OUT"}, 300},
  };
  return all;
}

/// A line of a file again and again, with numbers counted up.
template <class Line>
void write_lines(const fs::path& file, const std::string& head, int count, const Line& line) {
  std::string text = head;
  for (int i = 0; i < count; ++i) text += line(i) + '\n';
  tests::write_text(file, text);
}

/// A picture of 4096x4096 pixels in 50 kB: nearly 500 scans, each over the whole picture.
std::string picture_of_many_scans() {
  const auto segment = [](int kind, const std::string& content) {
    const std::size_t size = content.size() + 2;
    return std::string{'\xff', static_cast<char>(kind), static_cast<char>(size >> 8),
                       static_cast<char>(size & 0xff)} +
           content;
  };
  const auto huffman = [&](char kind, char symbol) {
    return segment(0xc4, std::string{kind, 1} + std::string(15, '\0') + symbol);
  };
  std::string jpeg = "\xff\xd8" + segment(0xdb, '\0' + std::string(64, '\1')) +
                     segment(0xc2, std::string("\x08\x10\0\x10\0\1\1\x11\0", 9)) + huffman(0, 0) +
                     huffman(0x10, '\xe0') + segment(0xda, std::string("\1\1\0\0\0\0", 6)) +
                     std::string(512 * 512 / 8, '\0');
  // Runs of 2^15 - 1 blocks without a coefficient, which end at the picture's.
  std::string bits;
  for (int left = 512 * 512; left > 0; left -= 32767) bits += "0" + std::string(14, '1');
  bits.resize((bits.size() + 7) / 8 * 8, '1');
  std::string runs;
  for (std::size_t i = 0; i < bits.size(); i += 8) {
    runs += static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2));
    if (runs.back() == '\xff') runs += '\0';
  }
  const auto scan = [&](int coefficient, int high, int low) {
    const auto k = static_cast<char>(coefficient);
    return segment(0xda, std::string{1, 1, 0, k, k, static_cast<char>(high << 4 | low)}) + runs;
  };
  for (int i = 0; i < 494; ++i) jpeg += scan(1 + i % 63, i < 63 ? 0 : 14 - i / 63, 13 - i / 63);
  return jpeg + "\xff\xd9";
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
    write_slow_files();
  }
  static void write_slow_files() {
    fs::copy(folder_ / "FLIGHT", folder_ / "SCANS", fs::copy_options::recursive);
    const std::string picture = picture_of_many_scans();
    for (const fs::directory_entry& file : fs::directory_iterator(folder_ / "SCANS/mav0/cam0/data"))
      tests::write_text(file.path(), picture);
    const fs::path sensor = folder_ / "SCANS/mav0/cam0/sensor.yaml";
    tests::write_text(sensor,
                      std::regex_replace(tests::read_text(sensor), std::regex("resolution: [^\n]*"),
                                         "resolution: [4096, 4096]"));
    constexpr int kFrames = 100'000;
    fs::copy(folder_ / "recorded", folder_ / "LONG", fs::copy_options::recursive);
    fs::remove(folder_ / "LONG/.leviosim-files");
    auto manifest = nlohmann::json::parse(tests::read_text(folder_ / "LONG/manifest.json"));
    manifest["data"]["frames"] = kFrames;
    tests::write_text(folder_ / "LONG/manifest.json", manifest.dump());
    auto record = nlohmann::json::parse(tests::read_text(folder_ / "LONG/run.json"));
    record["statistics"]["frames.count"][0] = kFrames;
    record["facts"]["frames"] = kFrames;
    tests::write_text(folder_ / "LONG/run.json", record.dump());
    const std::string frames = tests::read_text(folder_ / "LONG/frames.csv");
    const std::size_t first = frames.find('\n') + 1;
    const std::size_t stamp = frames.find(',', frames.find(',', first) + 1);
    const std::string rest = frames.substr(stamp, frames.find('\n', stamp) - stamp);
    write_lines(folder_ / "LONG/frames.csv", frames.substr(0, first), kFrames, [&](int i) {
      return fmt::format("{},{}{}", i, 1'000'000'000'000 + i * 50'000'000L, rest);
    });
    ASSERT_EQ(run_program(folder_,
                          {"history", "add", path("recorded"), "--file", path("HISTORY"),
                           "--commit", "c0", "--branch", "main", "--time", "1", "--subject", "s"})
                  .status,
              0);
    const std::string history = tests::read_text(folder_ / "HISTORY");
    const std::size_t run = history.find("{\"run\":\"c0\",\"time\":1,");
    ASSERT_NE(run, std::string::npos);
    const std::string line = history.substr(run + 21, history.find('\n', run) - run - 21);
    write_lines(folder_ / "HISTORY", history, 2'000, [&](int i) {
      return fmt::format("{{\"run\":\"c{0}\",\"time\":{0}{1}", i + 1, line);
    });
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
  double work_s = 0;   ///< of all processors in that time
};

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// What programs that have ended have used of processors.
double work_of_ended() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

/// What a running one has.
double work_of(pid_t program) {
  const std::string status = base::read_text_file(fmt::format("/proc/{}/stat", program));
  std::istringstream fields(status.substr(status.rfind(')') + 1));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

Stopped stop(const fs::path& folder, const std::vector<std::string>& words, int signal,
             std::chrono::milliseconds after) {
  const double before = work_of_ended();
  Program program(folder, words);
  std::this_thread::sleep_for(after);
  const double until_then = work_of(program.id());
  Stopped stopped;
  stopped.in_time = program.running();
  const auto begin = Clock::now();
  program.send(signal);
  while (program.running() && Clock::now() - begin < std::chrono::seconds(30))
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  stopped.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  if (program.running()) program.send(SIGKILL);
  stopped.status = program.wait().status;
  stopped.work_s = work_of_ended() - before - until_then;
  return stopped;
}

TEST_F(Interrupts, EndEveryCommandSoonAndLeaveNothingBehind) {
  std::mt19937 random(5);
  for (const Started& command : commands()) {
    int stopped_at_work = 0;
    double longest = 0;
    // Short commands are over before a late signal, so earlier ones follow until one came in time.
    for (int trial = 0; trial < 3 || (stopped_at_work == 0 && trial < 20); ++trial) {
      const int signal = trial % 2 == 0 ? SIGINT : SIGTERM;
      const std::chrono::milliseconds after(
          trial == 0  ? 5
          : trial < 3 ? 20 + random() % static_cast<unsigned>(command.latest_ms)
                      : static_cast<unsigned>(trial));
      const Stopped stopped = stop(folder_, words(command), signal, after);
      for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "work"))
        EXPECT_NE(entry.path().filename().string().front(), '.')  // staged
            << command.what << " leaves " << entry.path();
      fs::remove_all(folder_ / "work");
      fs::create_directory(folder_ / "work");
      // A process that had done all and was about to vanish takes no signal any more.
      const bool was_over = stopped.status == command.undisturbed && stopped.seconds < 0.5;
      if (!stopped.in_time || was_over) continue;
      ++stopped_at_work;
      longest = std::max(longest, stopped.work_s);
      EXPECT_EQ(stopped.status, 128 + signal)
          << command.what << " after " << after.count() << " ms";
      // Half a second of a machine that does nothing else.
      EXPECT_LT(stopped.work_s, 0.5) << command.what << " after " << after.count() << " ms";
    }
    EXPECT_GT(stopped_at_work, 0) << command.what;
    std::printf("[    STOPS ] %s: %d ms\n", command.what, static_cast<int>(1e3 * longest));
  }
}

TEST_F(Interrupts, CountWhereTheCallerIgnoresThemAndWhateverTheWork) {
  ProgramResult result;
  // Again where this process had to wait so long that the command was over.
  for (int trial = 0; trial < 10 && result.status <= 0; ++trial) {
    // Ignored, as shells start what runs in the background.
    const auto before = std::signal(SIGINT, SIG_IGN);
    Program program(folder_, {"validate", "--fit", "--data", path("FLIGHT")});
    std::signal(SIGINT, before);
    while (program.running() &&
           base::read_text_file(folder_ / "stderr.txt").find("frame 12/60") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    program.send(SIGINT);
    result = program.wait();
  }
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
