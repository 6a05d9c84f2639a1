// The place of an output, a file or a folder: what may lie there, and how what was staged takes its
// name. Nothing is replaced but what leviosim wrote, if the user asked for it. If the name is taken
// when everything is done, the output is left under another one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sim/outputs/file_system.h"
#include "sim/outputs/output_record.h"

namespace leviosim::outputs {

// The hidden folder .NAME.leviosim beside an output, where that is written first. One process at a
// time holds it, by the lock of the record in it; what a process that died left there is removed by
// the next. It is never more than a folder with a record (output_record.h): each file in it gets
// its name when it is whole and recorded.
//
// Left out: fsync(2). After a crash of the machine, not of the program, a file may hold less than
// its record says, and is then not taken for leviosim's.

class StagingFolder {
 public:
  /// @param shown  of the target, for messages
  /// @param patience  with a process that has it
  /// @throws InputError if another process holds it, something foreign is in it, or it cannot be
  ///         made; Interrupted
  StagingFolder(const std::filesystem::path& target, const std::string& shown,
                std::chrono::milliseconds patience);
  /// Removes it with what was written into it, but for what was renamed. Takes no memory.
  ~StagingFolder();
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file, "chosen/run.json", with the folders to it. Several threads may call it.
  /// @returns 0, or the error
  int write(const std::string& name, std::string_view bytes);
  /// Sets disk space aside until something is written. @returns 0, or the error
  int reserve(std::uint64_t bytes);
  /// Puts the record in order. @returns 0, or the error
  int finish();
  /// It is somewhere else now, or was given up: nothing is removed.
  void let_go() { let_go_ = true; }

  static std::filesystem::path place_of(const std::filesystem::path& target);

 private:
  explicit StagingFolder(std::filesystem::path path) : path_(std::move(path)) {}
  bool acquire(const std::string& shown, std::chrono::milliseconds patience);
  int make_folders(const std::string& name);
  int begin_file(Descriptor& file);
  int end_file(const char* name);

  std::filesystem::path path_;
  Descriptor folder_;
  std::optional<HeldRecord> record_;
  std::set<std::string> folders_;
  std::string unfinished_;  ///< name of the file that is being written
  Descriptor reserve_;
  std::mutex mutex_;
  bool is_clean_ = false;  ///< all that is in it was written by this process
  bool let_go_ = false;
};

/// What is asked of an output.
struct OutputRequest {
  std::string option;                              ///< that names it, for messages; may be empty
  std::string path;                                ///< as the user gave it
  bool replace = false;                            ///< what leviosim wrote there before
  std::vector<std::filesystem::path> inputs = {};  ///< that stay as they are; need not exist
  /// Of a folder: replace its files also if they were changed since, as those of a cache may be.
  bool repair = false;

  /// "--out results".
  std::string shown() const { return option.empty() ? path : option + ' ' + path; }
};

class OutputPlace {
 public:
  /// Where the output is in the end, as the user would name it.
  const std::string& shown_path() const { return shown_path_; }
  /// Without links.
  const std::filesystem::path& path() const { return target_; }

 protected:
  /// @throws InputError for a path that cannot be found out
  OutputPlace(OutputRequest request, const char* kind);

  const OutputRequest& request() const { return request_; }
  [[noreturn]] void refuse(const std::string& why) const;
  /// Gives what was staged its name. What it replaces lies in its old place then, for the staging
  /// folder or the caller to remove.
  /// @param is_ours  whether what has a path was written by leviosim; asked again once it is out of
  ///                 the way
  /// @returns nothing, or why it has another name now, which the text tells
  /// @throws InputError, Interrupted; nothing is changed then
  std::optional<std::string> put(StagingFolder& staging, const std::filesystem::path& staged,
                                 const std::function<bool(const std::filesystem::path&)>& is_ours);

 private:
  int replace(StagingFolder& staging, const std::filesystem::path& staged,
              const std::function<bool(const std::filesystem::path&)>& is_ours) const;
  std::string put_aside(const std::filesystem::path& staged, int error);

  OutputRequest request_;
  std::string shown_path_;
  std::filesystem::path target_;
};

}  // namespace leviosim::outputs
