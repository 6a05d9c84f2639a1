// A folder that all tests of a suite share: for what takes seconds to make and is only read.
#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace leviosim::tests {

/// Deleted at the end.
class SuiteFolder {
 public:
  explicit SuiteFolder(const std::string& suite)
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("leviosim-{}-{}", ::getpid(), suite)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~SuiteFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SuiteFolder(const SuiteFolder&) = delete;
  SuiteFolder& operator=(const SuiteFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace leviosim::tests
