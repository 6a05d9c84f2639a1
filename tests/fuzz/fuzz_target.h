// What all fuzz targets share. A target hands the bytes of libFuzzer to one reader of user's input
// and lets nothing pass but InputError, which is how readers refuse. Sanitizers find the rest.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/error.h"

namespace leviosim::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Between the parts of an input that is about several texts; seeds have it (seeds.cpp).
inline constexpr std::string_view kBetweenParts = "\n=%%=\n";

inline std::vector<std::string> parts_of(std::string_view input) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = input.find(kBetweenParts);
    parts.emplace_back(input.substr(0, end));
    if (end == std::string_view::npos) return parts;
    input.remove_prefix(end + kBetweenParts.size());
  }
}

/// Runs what reads the input. @returns 0, as libFuzzer wants it
template <class Read>
int only_input_errors(const Read& read) {
  try {
    read();
  } catch (const InputError&) {  // NOLINT: a refusal is all right
  }
  return 0;
}

/// A file in memory, for readers that take names of files.
class MemoryFile {
 public:
  /// @param suffix  of its name; may begin with folders, "-cache/ab/entry.json"
  explicit MemoryFile(const std::string& suffix)
      : path_("/dev/shm/leviosim-fuzz-" + std::to_string(::getpid()) + suffix) {
    std::filesystem::create_directories(path_.parent_path());
    file_ = ::open(path_.c_str(), O_CREAT | O_RDWR | O_TRUNC | O_CLOEXEC, 0600);
    if (file_ < 0) std::abort();
  }
  ~MemoryFile() {
    ::close(file_);
    std::filesystem::path top = path_;
    while (top.parent_path() != "/dev/shm") top = top.parent_path();
    std::error_code error;
    std::filesystem::remove_all(top, error);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::filesystem::path& holding(std::string_view content) {
    if (::ftruncate(file_, 0) != 0 ||
        ::pwrite(file_, content.data(), content.size(), 0) != static_cast<ssize_t>(content.size()))
      std::abort();
    return path_;
  }
  std::filesystem::path path() const { return path_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace leviosim::fuzz
