// The hidden folder .NAME.leviosim beside an output, where that is written first. One process at a
// time holds it, by the lock of the record in it; what a process that died left there is removed by
// the next. It is never more than a folder with a record (output_record.h): each file in it gets
// its name when it is whole and recorded.
//
// Left out: fsync(2). After a crash of the machine, not of the program, a file may hold less than
// its record says, and is then not taken for leviosim's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "sim/outputs/content.h"
#include "sim/outputs/file_system.h"
#include "sim/outputs/output_record.h"

namespace leviosim::outputs {

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
  /// @param state  set to what it holds; may be null
  int write(const std::string& name, const Content& content, FileState* state = nullptr);
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

}  // namespace leviosim::outputs
