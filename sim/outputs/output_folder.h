// A folder of results, which appears under its name only when it is whole.
//
// It is claimed before any work is done: what could be refused at the end is refused at the start.
// Until then it is written beside its place, in the hidden folder .NAME.leviosim, which one process
// at a time holds (flock(2) on the journal in it); what a process that died left there is removed
// by the next. Nothing is replaced but an empty folder and, if the user asked for it, a folder that
// holds nothing but what leviosim wrote (output_record.h). If the name is taken when everything is
// done, the results are left under another one.
//
// Left out: fsync(2). After a crash of the machine, not of the program, a file may hold less than
// its record says, and is then not taken for leviosim's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/outputs/file_system.h"
#include "sim/outputs/output_record.h"
#include "sim/outputs/output_request.h"

namespace leviosim::outputs {

/// The hidden folder beside the target, held until the end of its life. Removes what was written
/// into it unless it was renamed.
class StagingFolder {
 public:
  /// @param shown  of the target, for messages
  /// @throws InputError if another process holds it, something foreign is in it, or it cannot be
  ///         made
  StagingFolder(std::filesystem::path path, const std::string& shown);
  ~StagingFolder();
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// As OutputFolder's. Several threads may call it. @returns 0, or the error
  int write(const std::string& name, std::string_view bytes);
  /// Sets disk space aside until something is written. @returns 0, or the error
  int reserve(std::uint64_t bytes);
  /// Puts the record in place of the journal. @returns 0, or the error
  int finish();
  /// It is somewhere else now, or was given up: nothing is removed.
  void let_go() { held_ = false; }

 private:
  bool acquire(const std::string& shown);
  void remove_leftovers(const std::string& shown) const;

  std::filesystem::path path_;
  Descriptor journal_;
  Descriptor reserve_;
  OutputRecord record_;
  std::mutex mutex_;
  bool held_ = false;
};

class OutputFolder {
 public:
  /// @throws InputError naming the entry for which the folder cannot be used
  explicit OutputFolder(OutputRequest request);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Makes sure that so much can be written. [bytes] @throws InputError if the disk is full
  void reserve(std::uint64_t bytes);
  /// Writes a file, "chosen/stats.json", with the folders to it. Each name once; several threads
  /// may. @throws InputError if that fails
  void write(const std::string& name, std::string_view bytes);
  /// Gives the folder its name.
  /// @returns nothing, or why it has another name now, which the text tells
  [[nodiscard]] std::optional<std::string> commit();
  /// Where the results are after commit(), as the user would name it.
  const std::string& shown_path() const { return shown_path_; }

 private:
  [[noreturn]] void refuse(const std::string& why) const;
  void check_inputs() const;
  void judge() const;
  bool is_ours(const std::filesystem::path& folder) const;
  void make_parents();
  int publish();
  int replace();
  std::string move_aside();
  std::string publish_aside(int error);

  OutputRequest request_;
  std::string shown_path_;
  std::filesystem::path target_;
  std::vector<std::filesystem::path> made_parents_;
  std::optional<StagingFolder> staging_;
};

}  // namespace leviosim::outputs
