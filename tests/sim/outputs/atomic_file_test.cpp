#include "sim/outputs/file_system.h"

#include <gtest/gtest.h>

#include <iterator>

#include "tests/traces/test_folder.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;
using traces::testing::expect_input_error;
using traces::testing::TempFolder;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(AtomicFile, ReplacesAndLeavesNothingElse) {
  const TempFolder folder;
  write_file_atomically(folder / "a", "one");
  write_file_atomically(folder / "a", "two");
  EXPECT_EQ(base::read_text_file(folder / "a"), "two");
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(AtomicFile, FailsCleanly) {
  const TempFolder folder;
  expect_input_error([&] { write_file_atomically(folder / "none/a", "x"); }, {"cannot be written"});
  fs::create_directories(folder / "a/b");
  expect_input_error([&] { write_file_atomically(folder / "a", "x"); }, {"cannot be written"});
  EXPECT_EQ(entries(folder.path()), 1u);
}

}  // namespace
}  // namespace leviosim::outputs
