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
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

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

class History {
 public:
  /// @param text  of the file; empty: no runs
  /// @throws InputError with the line that is none of a history
  History(std::string file, std::string text);
  /// @throws InputError if there is no such file
  static History read(const std::string& file);

  std::size_t size() const { return runs_.size(); }
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

 private:
  struct Line {
    std::size_t begin;
    std::size_t size;
    std::int64_t time_s;
  };
  std::string_view bytes_of(const Line& line) const;
  Json parsed(const Line& line) const;
  const Json& kept(const std::string& digest) const;

  std::string file_;
  std::string text_;
  std::vector<Line> runs_;
  std::unordered_map<std::string_view, Line> kept_;  ///< by digest, in text_
  mutable std::unordered_map<std::string, Json> parsed_;
};

}  // namespace leviosim::tools
