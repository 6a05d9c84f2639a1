// The history of a project's runs in one file: a line of JSON for every run, and a line for each
// thing that runs share, named by the digest of what it holds. So a run whose cycles did not change
// takes a few hundred bytes, and the lines of two histories together are a history: the file lives
// well in version control (merge=union) or as an artifact.
//
//   {"kept":"8f3c…","what":"figures"|"facts"|"stage",…}    once, before the first run that needs it
//   {"run":"COMMIT","time":1764133200,"branch":"main",…}   figures, limits, what it shares
//
// A run is read back as a baseline holds it (budget/baseline.h): figures, and the larger parts of
// each stage's cycles. Left out: frames, files of runs, hosts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "sim/base/opened_file.h"
#include "sim/outputs/file_system.h"
#include "tools/app/comparison/run_record.h"

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

/// A text of which a piece is held at a time, however long it is.
class Pieces {
 public:
  explicit Pieces(std::string whole) : held_(std::move(whole)), size_(held_.size()) {}
  explicit Pieces(base::OpenedFile file) : size_(file.size()), file_(std::move(file)) {}

  std::uint64_t size() const { return size_; }
  /// Valid until the next call. @throws InputError if the file has become shorter
  std::string_view at(std::uint64_t begin, std::size_t size);
  /// What stands before the next line break or the end. As at()
  std::string_view line_at(std::uint64_t begin);
  /// How many bytes were read from the file.
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  void hold(std::uint64_t begin, std::size_t size);
  std::string_view held_from(std::uint64_t begin) const;

  std::string held_;
  std::uint64_t begin_ = 0;  ///< of what is held
  std::uint64_t size_;
  std::uint64_t bytes_read_ = 0;
  std::optional<base::OpenedFile> file_;
};

class History {
 public:
  /// Where the lines are; parses none of them. A line that lacks its end, as an interrupted program
  /// leaves it, is passed over.
  /// @param text  empty: no runs
  /// @throws InputError with the line that is none of a history
  History(std::string file, Pieces text);
  /// @throws InputError if there is no such file
  static History read(const std::string& file);

  std::size_t size() const { return runs_.size(); }
  /// Of the file, without a line that lacks its end. [bytes]
  std::uint64_t whole_size() const { return whole_size_; }
  bool ends_a_line() const;
  /// By time, then in the order of the file; a line that stands twice is one run. @throws InputError if a line is damaged
  Origin origin(std::size_t i) const;
  PastRun run(std::size_t i) const;

  /// The newest runs that can be compared with one, the oldest of them first: of the same data,
  /// profile, chip, size, seed and frames. @param branch  "": of all  @param most  of them
  std::vector<PastRun> like(const RunRecord& run, const std::string& branch,
                            std::size_t most) const;

  /// What has to be appended to the file for a run; nothing if it is there already.
  /// @throws InputError if this commit has such a run with other figures
  std::string lines_for(const PastRun& run) const;

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
  const Json& kept(const std::string& digest) const;

  std::string file_;
  mutable Pieces pieces_;
  std::uint64_t whole_size_ = 0;
  std::vector<Line> runs_;
  std::unordered_map<std::string, Line> kept_;  ///< by digest
  mutable std::unordered_map<std::string, Json> parsed_;
  mutable std::size_t lines_parsed_ = 0;
};

/// The file while a run is added to it. Others that add wait.
class GrowingHistory {
 public:
  /// @throws InputError if there is another thing of that name, or if others add all the time;
  ///         Interrupted
  explicit GrowingHistory(const std::string& file);

  const History& history() const { return *history_; }
  /// At the end, all or nothing; makes the file if there is none. Nothing else of it is touched, so
  /// that what is written does not grow with the file. @throws InputError if that fails
  void append(std::string lines);

 private:
  void open(int more_flags);

  std::string name_;
  outputs::Descriptor file_;
  std::optional<History> history_;
};

}  // namespace leviosim::tools
