// Which files of a folder leviosim wrote, and what it wrote into them: the file .leviosim-files in
// the folder. Only what it names is ever replaced or removed, and only if it still holds that.
//
//   leviosim files 1
//   <SHA-256> <size> <path>
//   - - <path>                     what changes all the time, such as a data base
//
// A path may have several lines: all that was written under that name. What has no digest is not
// known to hold what leviosim wrote, and so is never replaced or removed. A line is added before
// what it describes gets its name. Paths are relative; control characters, '%' and bytes beyond
// ASCII are written as %XX. A last line without its end was cut off by a kill, and does not count.
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
  static std::string line(const std::string& path, const FileState& state);

  void add(const std::string& path, const FileState& state) { files_.emplace(path, state); }
  bool names(const std::string& path) const { return files_.count(path) > 0; }
  bool says(const std::string& path, const FileState& state) const;
  /// Whether leviosim wrote the file `path` of the folder as it is now. @throws Interrupted
  /// @param any_bytes  a recorded file counts whatever it holds now
  bool describes(const std::filesystem::path& folder, const std::string& path,
                 bool any_bytes = false) const;
  /// Whether a path lies below the folder.
  bool leads_through(const std::string& folder) const;
  /// Whether all files are there as they were written. @throws Interrupted
  bool is_complete(const std::filesystem::path& folder) const;
  /// Each once.
  std::vector<std::string> paths() const;
  /// Removes the files, whatever they hold. Takes no memory.
  void remove_files(const Descriptor& folder) const;

 private:
  std::multimap<std::string, FileState> files_;
};

/// The name of a file that is being written has the number of its inode, which no archive and no
/// copy can know. So what a kill left is known to be leviosim's.
std::string unfinished_name(const struct stat& file);
/// It has this one, and is empty, until that number is known.
inline constexpr const char* kUnnumbered = ".leviosim-new";

/// What is in a folder: the one place that decides what is leviosim's, and may be removed.
struct FolderContents {
  std::optional<OutputRecord> record;
  std::vector<std::string> files;    ///< of leviosim, but for the record
  std::vector<std::string> folders;  ///< that its paths lead through, each before those in it
  /// The first entry that leviosim did not write as it is now. Nothing after it was looked at.
  std::string foreign;

  bool is_ours() const { return record && foreign.empty(); }
  /// Removes files and folders, but not the record. Takes no memory.
  void remove(const Descriptor& folder) const;
};
/// @param any_bytes  recorded files are leviosim's whatever they hold now
/// @throws InputError for what is no record, Interrupted
FolderContents contents_of(const std::filesystem::path& folder, bool any_bytes = false);

/// The record of a folder while lines are added to it: one process at a time.
class HeldRecord {
 public:
  enum class State {
    held,
    busy,       ///< another process has it
    unwritable  ///< another user's, as in /tmp: what is written there is not recorded, and so
                ///< never replaced. Or the folder is gone.
  };

  /// Makes the file if there is none. @throws Interrupted while it waits for others; InputError for
  /// what is no record, and for what has other names, too, and must not be written through them
  HeldRecord(const std::filesystem::path& folder, std::chrono::milliseconds patience);

  State state() const { return state_; }
  const OutputRecord& record() const { return record_; }
  bool is_empty() const;
  /// Adds a line, unless it is there. @throws InputError if that fails
  void add(const std::string& path, const FileState& state);
  /// @throws InputError if that fails
  void clear();
  /// The file itself was replaced by another one, which holds the same and is locked.
  void become(Descriptor file) { file_ = std::move(file); }

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  Descriptor file_;
  State state_ = State::unwritable;
  OutputRecord record_;
};

/// For how long a process waits for one that adds a line.
inline constexpr std::chrono::milliseconds kPatience{5000};

/// The record of a folder that others write to, too.
/// @throws InputError, also if it is busy for too long; Interrupted
HeldRecord shared_record(const std::filesystem::path& folder);

/// Adds a line to the record of a folder, for what is not written through OutputFile.
/// @throws InputError if that fails
void add_to_record(const std::filesystem::path& folder, const std::string& name,
                   const FileState& state);

}  // namespace leviosim::outputs
