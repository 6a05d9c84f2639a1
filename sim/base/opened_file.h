// A file that a user names, under the conditions of read_file() (input_file.h), for those who need it
// in pieces.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/base/input_file.h"

namespace leviosim::base {

class OpenedFile {
 public:
  /// @throws InputError as read_file()
  OpenedFile(std::filesystem::path path, InputKind kind);
  /// Takes over what is open already, as `path` for messages. @param descriptor  or -errno
  OpenedFile(std::filesystem::path path, InputKind kind, int descriptor);
  ~OpenedFile();
  OpenedFile(OpenedFile&& other) noexcept;
  OpenedFile& operator=(OpenedFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  /// When it was opened. [bytes]
  std::uint64_t size() const { return size_; }
  /// Reads as many bytes as the piece has. @throws InputError if it cannot be read or has fewer now
  void read_piece(std::uint64_t begin, std::string& piece) const;
  /// All bytes, also of files that grow meanwhile. @throws InputError
  std::string read_all() const;

 private:
  /// @returns how many bytes were read: fewer than `most` at the end of the file only
  std::size_t read_at(std::uint64_t begin, char* to, std::size_t most) const;
  void require_size(std::uint64_t bytes) const;
  [[noreturn]] void refuse(std::string_view reason) const;

  std::filesystem::path path_;
  InputKind kind_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace leviosim::base
