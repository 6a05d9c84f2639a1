// Fixture of command-line tests: a folder that all tests of a suite share, and the program in it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace leviosim::tests {

/// SetUpTestSuite() of a suite calls make_folder() and fills it; it is deleted after the last test.
class ProgramSuite : public ::testing::Test {
 protected:
  static void make_folder(const std::string& suite) { folder_ = new TemporaryFolder(suite); }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string path(const std::string& name) { return (*folder_ / name).string(); }
  static tools::testing::ProgramResult program(const std::vector<std::string>& words) {
    return tools::testing::run_program(folder_->path(), words);
  }
  static void expect_done(const std::vector<std::string>& words) {
    const tools::testing::ProgramResult result = program(words);
    ASSERT_EQ(result.status, 0) << result.err;
  }

  inline static TemporaryFolder* folder_ = nullptr;
};

}  // namespace leviosim::tests
