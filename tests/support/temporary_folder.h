// Folders that tests write to, which go with them.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace leviosim::tests {

/// Of this process; empty at first, deleted at the end.
class TemporaryFolder {
 public:
  /// @param name  tells the folders of a process apart
  explicit TemporaryFolder(std::string name) {
    std::replace(name.begin(), name.end(), '/', '-');  // of tests with parameters
    path_ =
        std::filesystem::temp_directory_path() / fmt::format("leviosim-{}-{}", ::getpid(), name);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Of the present test, which may have several.
class Scratch : public TemporaryFolder {
 public:
  Scratch() : TemporaryFolder(next_name()) {}

 private:
  static std::string next_name() {
    static int made = 0;
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    return fmt::format("{}-{}-{}", info->test_suite_name(), info->name(), ++made);
  }
};

}  // namespace leviosim::tests
