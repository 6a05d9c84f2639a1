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
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/pieces.h"
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

}  // namespace leviosim::tools
