// Files in folders to try things in, and pictures of what lies there.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "tests/support/temporary_folder.h"

namespace leviosim::tests {

/// With the folders to it.
inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Every entry below a folder: "file: BYTES", "link: TARGET" or "folder". Links are not followed.
inline std::map<std::string, std::string> picture_of(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> entries;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_symlink())
      entries[name] = "link: " + fs::read_symlink(entry.path()).string();
    else if (entry.is_directory())
      entries[name] = "folder";
    else
      entries[name] = "file: " + read_text(entry.path());
  }
  return entries;
}

}  // namespace leviosim::tests
