// What std::filesystem lacks: descriptors that close themselves, files that are opened without
// following links or waiting for pipes, locks that keep nobody waiting, and renames that replace
// nothing.
#pragma once

#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace leviosim::outputs {

/// An open file; -1 if there is none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }

  int get() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  /// Some file systems say only now that a write failed. @returns 0, or the error
  int close();

 private:
  int number_ = -1;
};

/// "No space left on device".
std::string reason(int error);

/// Of the path itself, if it is a symbolic link; nothing if there is nothing. [stat(2)]
std::optional<struct stat> status_of(const std::filesystem::path& path);
bool is_same_file(const struct stat& a, const struct stat& b);

/// What a regular file holds.
struct FileState {
  std::string sha256;  ///< 64 hexadecimal digits; empty: whatever it holds
  std::uint64_t size = 0;
  bool operator==(const FileState&) const = default;
};
FileState state_of_bytes(std::string_view bytes);
/// Nothing for what is no regular file, larger than leviosim's files are, or cannot be read.
/// @throws Interrupted
std::optional<FileState> state_of_file(const std::filesystem::path& path);

/// @returns nothing if it is not there, no regular file, larger than `most` or cannot be read
std::optional<std::string> try_read_file(const std::filesystem::path& path, std::uint64_t most);
/// The same of what is open.
std::optional<std::string> try_read_file(const Descriptor& file, std::uint64_t most);

/// What a folder holds; nothing if it cannot be listed. (Those of std::filesystem end the program
/// where there is no memory.)
std::optional<std::set<std::string>> names_in(const std::filesystem::path& folder);

/// Writes all bytes. @returns 0, or the error
int write_all(int descriptor, std::string_view bytes);

/// Takes an exclusive flock(2); where the file system knows none, nobody is excluded.
/// @returns false if another process has it for longer than `patience`
/// @throws Interrupted while it waits
bool lock(int descriptor, std::chrono::milliseconds patience);

/// Renames a file or a folder to a name that does not exist. @returns 0, or EEXIST or another error
int rename_new(const std::filesystem::path& from, const std::filesystem::path& to);

/// Exchanges the names of two files or of two folders, in one step where the file system can.
/// @returns 0, or the error
int exchange(const std::filesystem::path& a, const std::filesystem::path& b);
/// Exchanges two files in three steps, for file systems that cannot do it at once. Stopped in
/// between, what b was has a name beside it, free_name(b, …).
int exchange_by_steps(const std::filesystem::path& a, const std::filesystem::path& b);

/// "results-2" or "figures-2.json" beside the file: the k-th of its names.
std::filesystem::path free_name(const std::filesystem::path& path, int k);

/// The path without symbolic links, "." and ".."; what does not exist yet is kept as it is.
/// Leaves a link that leads nowhere as it is.
/// @param error  set if that is not possible, as for links that lead to each other
std::filesystem::path resolved(const std::string& path, std::error_code& error);

/// Whether a path lies in a folder or is it, through whatever names; false if either does not
/// exist.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder);

/// A file that is never half-written: it appears under its name only when complete. It replaces
/// whatever has the name; results that users ask for go through sim/outputs/output_folder.h
/// instead. Writes beside `file` and renames. Throws InputError if the folder cannot be written.
void write_file_atomically(const std::filesystem::path& file, std::string_view contents);

}  // namespace leviosim::outputs
