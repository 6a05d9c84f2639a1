// Output that is never half-written: files and folders appear under their name only when complete.
#pragma once

#include <filesystem>
#include <string_view>

namespace leviosim::traces {

/// Writes beside `file` and renames. Throws InputError if the folder cannot be written.
void write_file_atomically(const std::filesystem::path& file, std::string_view contents);

/// A new empty folder beside `target`. commit() gives it the target's name; without it the
/// destructor deletes it.
class StagedFolder {
 public:
  /// Throws InputError if the folder cannot be made.
  explicit StagedFolder(std::filesystem::path target);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  const std::filesystem::path& path() const { return staging_; }
  /// Renames, replacing what has the target's name. Throws InputError if that fails.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
  bool committed_ = false;
};

}  // namespace leviosim::traces
