// The history of a project's runs in one file: a line of JSON for every run, so that the lines of
// two histories together are a history: the file lives well in version control (merge=union) or as
// an artifact.
//
//   {"run":"COMMIT","time":1764133200,"like":"8f3c…","branch":"main","subject":…,
//    "limits":{"held":4,"missed":[…]},"record":{…}}
//
// A run is read back as a baseline holds it (record/record.h, Level::kept). Runs that can be
// compared have the same digest "like", so that others need not be parsed. Left out: frames, files
// of runs, hosts.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/pieces.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/check.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Where a run comes from.
struct Origin {
  std::string commit;
  std::string branch;
  std::int64_t time_s = 0;  ///< since 1970, of the commit
  std::string subject;      ///< of the commit's message; may be empty
};

/// How a run met its limits when it was added.
struct LimitsThen {
  std::size_t held = 0;
  std::vector<std::string> missed;  ///< titles of those that were not met
};

struct PastRun {
  Origin origin;
  LimitsThen limits;
  RunRecord record;  ///< its name is that of the commit, shortened
};

/// "8f3c2a1": as people name a commit.
std::string short_commit(const std::string& commit);

class History {
 public:
  /// Where the lines are; parses none of them. A line that lacks its end, as an interrupted program
  /// leaves it, is passed over.
  /// @param text  empty: no runs
  /// @throws InputError with the line that is none of a history
  History(std::string file, base::Pieces text);
  /// @throws InputError if there is no such file
  static History read(const std::string& file);

  std::size_t size() const { return runs_.size(); }
  /// Of the file, without a line that lacks its end. [bytes]
  std::uint64_t whole_size() const { return whole_size_; }
  bool ends_a_line() const;
  /// By time, then in the order of the file; a line that stands twice is one run. @throws
  /// InputError if a line is damaged
  Origin origin(std::size_t i) const;
  PastRun run(std::size_t i) const;

  /// The newest runs that can be compared with one, the oldest of them first: of the same data,
  /// profile, chip, size, seed and frames. @param branch  "": of all  @param most  of them
  std::vector<PastRun> like(const RunRecord& run, const std::string& branch,
                            std::size_t most) const;

  /// What has to be appended to the file for a run; nothing if it is there already.
  /// @throws InputError if this commit has such a run with other figures
  std::string line_for(const PastRun& run) const;

  /// How many lines were parsed, and bytes read from the file, since it was opened.
  std::size_t lines_parsed() const { return lines_parsed_; }
  std::uint64_t bytes_read() const { return pieces_.bytes_read(); }

 private:
  struct Line {
    std::uint64_t begin = 0;
    std::size_t size = 0;
    std::int64_t time_s = 0;
    std::size_t hash = 0;
  };
  void add_line(std::string_view text, Line line, std::size_t number);
  std::string_view text_of(const Line& line) const { return pieces_.at(line.begin, line.size); }
  Json parsed(const Line& line) const;

  std::string file_;
  mutable base::Pieces pieces_;
  std::uint64_t whole_size_ = 0;
  std::vector<Line> runs_;
  mutable std::size_t lines_parsed_ = 0;
};

/// Adds a run to a file, made if there is none. Others that add wait.
/// @param lines  line_for() a run, of the history as it is now; may be called several times
/// @throws InputError as outputs::add_lines(), and for what is no history; Interrupted
void add_to_history(const std::string& file,
                    const std::function<std::string(const History&)>& lines);

// What became of the figures of a budget over many runs. Runs have no noise: every change of a
// figure is one of a commit. A change beyond a limit is a step; smaller ones that are beyond it
// together are a drift, which no comparison with the run before shows.

/// A change of a figure from one run to the next.
struct FigureChange {
  std::size_t run = 0;  ///< that has the new value
  double percent = 0;   ///< of the value before; above 0: worse
};

/// A figure over runs, the oldest first, held against a limit in per cent of a baseline.
struct Trend {
  const Limit* limit = nullptr;
  const BudgetSection* section = nullptr;
  std::string statistic;
  std::string stage;  ///< its name; empty: the run as a whole
  std::string unit;
  std::vector<std::optional<double>> values;
  double allowed = 0;               ///< of a change for the worse, in per cent
  std::vector<FigureChange> steps;  ///< for the worse, beyond the limit
  std::vector<FigureChange> drift;  ///< the others, if they are beyond it together; else none
  double drift_percent = 0;         ///< their sum
};

/// Of every limit with a sign and %, for figures that some of the runs have. The budget outlives
/// the trends.
std::vector<Trend> trends(const Budget& budget, const std::vector<PastRun>& runs);

/// "drift of +2.0 % in 10 commits, none above +0.2 %: 8f3c2a1 … 99ab01c".
std::string drift_text(const Trend& trend, const std::vector<PastRun>& runs);
/// "step of +3.0 % at 8f3c2a1 (make EPnP exact): solve EPnP: issue: f64_add +2.9 %".
std::string step_text(const Trend& trend, const FigureChange& step,
                      const std::vector<PastRun>& runs);

/// Adds to what a check found of a run what the runs before it tell: limits that it holds, but only
/// since the baseline moved along; and of limits that are not met, whether they were met before.
/// @param before  runs like it, the oldest first; may be none
void add_history(CheckResult& result, const RunRecord& run, const Budget& budget,
                 const std::vector<PastRun>& before);

// A history for people: a table of its newest runs, and a page with charts over commits.

/// "2026-11-26", in UTC.
std::string date_text(std::int64_t time_s);

/// A row a run with what changed, the newest last, and what became of the limits of a budget.
/// @param runs    comparable ones, the oldest first
/// @param budget  whose steps and drifts are named; may be null
/// @param next    command lines to try
Printout history_printout(const std::vector<PastRun>& runs, const Budget* budget,
                          std::vector<std::string> next);

/// The same as JSON: a list of runs with their figures.
std::string history_document(const std::vector<PastRun>& runs);

/// The figures of a run as other trackers read them: "github-action-benchmark" (smaller is better),
/// or "bencher" (Bencher Metric Format). @throws InputError for another format
std::string exported(const PastRun& run, const std::string& format);

/// Charts of the figures over runs, with the limits of the budget, and two runs beside each other.
/// Of long histories the runs that changed something, and the newest.
Json history_page(const std::string& title, const std::vector<PastRun>& runs, const Budget* budget);

}  // namespace leviosim::tools
