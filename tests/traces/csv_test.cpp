#include "sim/base/csv.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

using testing::expect_input_error;
using testing::TempFolder;

TEST(Csv, SkipsCommentsAndTrimsCells) {
  const TempFolder folder;
  outputs::write_file_atomically(folder / "a.csv", "# one\n 1 , +2.5e1 \r\n# two\n3,-4");
  base::CsvReader csv(folder / "a.csv", base::Separator::comma, {"a", "b"});
  const base::CsvRow* row = csv.next();
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->line(), 2u);
  EXPECT_EQ(row->nanoseconds(0), 1);
  EXPECT_EQ(row->number(1), 25);
  row = csv.next();
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->line(), 4u);
  EXPECT_EQ(row->number(1), -4);
  EXPECT_EQ(csv.next(), nullptr);
}

TEST(Csv, BlanksSeparateWhereAsked) {
  const TempFolder folder;
  outputs::write_file_atomically(folder / "a.txt", "  1\t2   3 \n");
  base::CsvReader csv(folder / "a.txt", base::Separator::blanks, {"a", "b", "c"});
  const base::CsvRow* row = csv.next();
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->text(1), "2");
  EXPECT_EQ(row->text(2), "3");
}

TEST(Csv, LongCellsAreCutInMessages) {
  const TempFolder folder;
  outputs::write_file_atomically(folder / "a.csv", std::string(500, 'x'));
  base::CsvReader csv(folder / "a.csv", base::Separator::comma, {"a"});
  const base::CsvRow* row = csv.next();
  ASSERT_NE(row, nullptr);
  try {
    row->number(0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), 300u);
  }
}

TEST(Csv, MissingFilesAndFolders) {
  const TempFolder folder;
  expect_input_error([&] { base::read_text_file(folder / "none"); }, {"none", "cannot be opened"});
  expect_input_error([&] { base::read_text_file(folder.path()); }, {"cannot be opened"});
}

}  // namespace
}  // namespace leviosim::traces
