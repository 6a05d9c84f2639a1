// Runs the leviosim program as a user would, and shows what it printed and how it ended.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/csv.h"
#include "tests/support/paths.h"
#include "tests/traces/test_folder.h"
#include "tools/app/cli/screen.h"

namespace leviosim::tools::testing {

struct ProgramResult {
  int status = -1;  ///< exit status, or 128 + the signal that ended the program
  std::string out;
  std::string err;
};

/// What a program may use before the system ends it; 0: as much as it likes.
struct ProgramLimits {
  std::uint64_t cpu_seconds = 0;
  std::uint64_t data_bytes = 0;  ///< private memory that it can write to
  bool one_screen = false;       ///< as users have it; else all results are printed
};

/// The environment of programs that print all of their results, instead of a screen of them.
class AllLines {
 public:
  AllLines() {
    for (char** variable = environ; *variable != nullptr; ++variable)
      if (std::string_view(*variable).rfind("LINES=", 0) != 0) variables_.push_back(*variable);
    variables_.push_back(lines_.data());
    variables_.push_back(nullptr);
  }
  char** data() { return variables_.data(); }

 private:
  std::string lines_ = "LINES=0";
  std::vector<char*> variables_;
};

/// The largest number in a column of a CSV file, 0 without any.
inline double largest_in_column(const std::filesystem::path& csv, std::string_view name) {
  double largest = 0;
  std::ptrdiff_t column = -1;
  std::istringstream rows(base::read_text_file(csv));
  for (std::string row; std::getline(rows, row);) {
    std::istringstream cells(row);
    std::ptrdiff_t at = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++at) {
      if (cell == name) column = at;
      double number = 0;
      if (at == column && base::parse_number(cell, number)) largest = std::max(largest, number);
    }
  }
  return largest;
}

/// What is wrong with the verdicts of the run in a folder, by its other figures: they may not all
/// be green where the error is above a tenth of the path (of 1 m or more), or a pose comes more
/// than a period late. Empty if nothing is.
inline std::string verdict_fault(const std::filesystem::path& run) {
  const auto document = nlohmann::json::parse(base::read_text_file(run / "run.json"));
  const auto& values = document.at("statistics");
  const auto number = [&](const std::string& name) {
    const auto found = values.find(name);
    return found != values.end() && found->at(0).is_number() ? found->at(0).get<double>() : 0;
  };
  if (document.at("verdicts").size() < 3) return {};
  for (const auto& verdict : document.at("verdicts"))
    if (verdict.at("grade") != "good") return {};
  const double path = number("accuracy.truth_length");
  const double share = path < 1 ? 0 : number("accuracy.ate.rmse") / path;
  if (share > 0.1) return fmt::format("green over an error of {:.1f} % of the path", 100 * share);
  const double periods =
      largest_in_column(run / "frames.csv", "latency_ns") / number("run.frame_period");
  if (periods > 2) return fmt::format("green over a pose {:.1f} periods after its image", periods);
  return {};
}

/// A running program with its output in files of `folder`. Runs are held to verdict_fault().
class Program {
 public:
  Program(const std::filesystem::path& folder, std::vector<std::string> words,
          const ProgramLimits& limits = {})
      : out_(folder / "stdout.txt"), err_(folder / "stderr.txt") {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    constexpr int kFlags = O_CREAT | O_WRONLY | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out_.c_str(), kFlags, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_.c_str(), kFlags, 0600);
    if (const auto out = std::find(words.begin(), words.end(), "--out");
        words.end() - out > 1 && (words.front() == "run" || words.front() == "replay"))
      run_ = *(out + 1);
    const std::string program = leviosim::tests::program_path();
    words.insert(words.begin(), program);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int error = posix_spawn(&pid_, program.c_str(), &files, nullptr, arguments.data(),
                                  limits.one_screen ? environ : AllLines().data());
    posix_spawn_file_actions_destroy(&files);
    EXPECT_EQ(error, 0) << program;
    limit(RLIMIT_CPU, limits.cpu_seconds);
    limit(RLIMIT_DATA, limits.data_bytes);
  }

  pid_t id() const { return pid_; }
  void send(int signal) const { ::kill(pid_, signal); }
  bool running() {
    if (pid_ > 0 && !ended_) ended_ = ::waitpid(pid_, &wait_status_, WNOHANG) == pid_;
    return !ended_;
  }
  ProgramResult wait() {
    if (!ended_) ::waitpid(pid_, &wait_status_, 0);
    ended_ = true;
    ProgramResult result;
    result.status =
        WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : 128 + WTERMSIG(wait_status_);
    result.out = base::read_text_file(out_);
    result.err = base::read_text_file(err_);
    if (result.status == 0 && std::filesystem::exists(run_ / "run.json")) {
      EXPECT_EQ(verdict_fault(run_), "") << run_;
    }
    return result;
  }

 private:
  void limit(__rlimit_resource resource, std::uint64_t most) const {
    if (most == 0) return;
    const rlimit values{most, most};
    ::prlimit(pid_, resource, &values, nullptr);
  }

  std::filesystem::path out_;
  std::filesystem::path err_;
  std::filesystem::path run_;  ///< what it makes, if it is a run
  pid_t pid_ = -1;
  int wait_status_ = 0;
  bool ended_ = false;
};

inline ProgramResult run_program(const std::filesystem::path& folder,
                                 std::vector<std::string> words) {
  return Program(folder, std::move(words)).wait();
}

/// The same with a screen of results.
inline ProgramResult run_on_screen(const std::filesystem::path& folder,
                                   std::vector<std::string> words) {
  return Program(folder, std::move(words), {.one_screen = true}).wait();
}

/// What is wrong with a screen of 24 lines of 80 columns that says what came out and what to do
/// next; empty if it is one. Paths and command lines may be wider.
inline std::string screen_fault(const std::string& text) {
  std::istringstream in(text);
  int lines = 0;
  bool concludes = false;
  bool goes_on = false;
  for (std::string line; std::getline(in, line); ++lines) {
    for (const char* conclusion : {"verdict: ", "in short: ", "synthetic flight: ",
                                   "rendered flight: ", "platform: ", "report: ", "results: "})
      concludes = concludes || line.rfind(conclusion, 0) == 0;
    // Of a page nothing follows, nor of limits that no point meets.
    goes_on = goes_on || line.rfind("report: ", 0) == 0 || line.rfind("verdict: NOT met", 0) == 0;
    const bool is_next = line.rfind("next: ", 0) == 0 || line.rfind("Next: ", 0) == 0;
    goes_on = goes_on || is_next;
    const bool has_blanks = line.find(' ', line.find(": ") + 2) != std::string::npos;
    if (display_width(line) > kScreenColumns && !is_next && has_blanks &&
        line.rfind("      leviosim ", 0) != 0)
      return "too wide: " + line;
  }
  if (lines > kScreenLines) return fmt::format("{} lines", lines);
  if (!concludes) return "it does not say what came out";
  return goes_on || text.rfind("platform: ", 0) == 0 ? std::string()
                                                     : "it does not say what to do next";
}

/// The program refused: exit status 2 and one message, which contains all parts.
inline void expect_refused(const ProgramResult& result, const std::vector<std::string>& parts,
                           int status = 2) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.rfind("leviosim: ", 0), 0u) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  for (const std::string& part : parts)
    EXPECT_NE(result.err.find(part), std::string::npos)
        << "'" << part << "' is not in: " << result.err;
}

}  // namespace leviosim::tools::testing
