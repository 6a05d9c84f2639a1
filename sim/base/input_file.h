// How every file that a user names is read: regular files only, whole, and no larger than files of
// its kind ever are. A FIFO, a device, a socket or a folder is refused before anything is read from
// it, so that no input keeps the program waiting. Links to regular files are followed.
// Left out: what is in the files; files that leviosim writes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace leviosim::base {

enum class InputKind {
  platform,
  plan,
  sensor,
  table,
  image,
  film,
  work_trace,
  cached_result,
  run_file,
  budget,
  baseline,
  history,
  points
};

struct InputKindInfo {
  InputKind kind;
  const char* name;         ///< with its article: "a work trace"
  std::int64_t most_bytes;  ///< a larger file is refused
};
const InputKindInfo& info_of(InputKind kind);

/// All bytes of a file. Throws InputError "PATH: cannot be opened as KIND: REASON" for what is
/// missing, no regular file or not readable, and if it is larger than its kind allows.
std::string read_file(const std::filesystem::path& path, InputKind kind);

/// What a path leads to, behind all links.
enum class PathKind { missing, file, folder, other };

/// Throws InputError with the system's reason if that cannot be found out: links in a circle, names
/// that are too long, folders that may not be searched.
PathKind kind_of(const std::filesystem::path& path);

inline bool exists(const std::filesystem::path& path) { return kind_of(path) != PathKind::missing; }
inline bool is_file(const std::filesystem::path& path) { return kind_of(path) == PathKind::file; }
inline bool is_folder(const std::filesystem::path& path) {
  return kind_of(path) == PathKind::folder;
}

}  // namespace leviosim::base
