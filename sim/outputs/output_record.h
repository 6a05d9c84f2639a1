// Which files of a folder leviosim wrote, and what it wrote into them: the file .leviosim-files in
// the folder. Only what it names is ever replaced or removed, and only if it still holds that.
//
//   leviosim files 1
//   <SHA-256> <size> <path>
//   - - <path>                     what changes all the time, such as a data base
//
// A path may have several lines: all that was written under that name. What has no digest is not
// known to hold what leviosim wrote, and so is never replaced or removed by what a record says. The
// record of a folder that is being written is its journal: it begins "leviosim journal 1 PROCESS",
// and a file is named in it before it is made; there, what has no digest was being written. Paths
// are relative; control characters, '%' and bytes beyond ASCII are written as %XX. A last line
// without its end was cut off by a kill, and does not count.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/outputs/file_system.h"

namespace leviosim::outputs {

inline constexpr const char* kRecordName = ".leviosim-files";

class OutputRecord {
 public:
  /// @param name  of the file, for messages
  /// @throws InputError for what is no record
  static OutputRecord parse(std::string_view text, const std::string& name);
  /// Of a folder; nothing if it has none. @throws InputError for what is no record
  static std::optional<OutputRecord> read(const std::filesystem::path& folder);

  /// The whole file, in the order of the paths.
  std::string text() const;
  static std::string header() { return "leviosim files 1\n"; }
  static std::string journal_header();
  static std::string line(const std::string& path, const FileState& state);

  void add(const std::string& path, const FileState& state) { files_.emplace(path, state); }
  bool names(const std::string& path) const { return files_.count(path) > 0; }
  bool says(const std::string& path, const FileState& state) const;
  /// Whether leviosim wrote the file `path` of the folder as it is now.
  bool describes(const std::filesystem::path& folder, const std::string& path) const;
  /// The first entry below the folder, in the order of names, that leviosim did not write as it is
  /// now; empty if there is none. Folders are leviosim's if a path leads through them.
  /// @param any_bytes  recorded files count whatever they hold now
  std::string first_foreign(const std::filesystem::path& folder, bool any_bytes = false) const;
  /// Whether all files are there as they were written.
  bool is_complete(const std::filesystem::path& folder) const;
  /// Removes the files that are named and the folders that this empties.
  void remove_files_from(const std::filesystem::path& folder) const;
  /// Also the record, and the folder if nothing is left in it.
  void remove_from(const std::filesystem::path& folder) const;
  /// Of a journal whose files are all written.
  void drop_states_without_digest();

  /// That writes it, if it is a journal; else 0.
  int process() const { return process_; }
  /// Each once.
  std::vector<std::string> paths() const;

 private:
  bool leads_through(const std::string& folder) const;

  std::multimap<std::string, FileState> files_;
  int process_ = 0;
};

}  // namespace leviosim::outputs
