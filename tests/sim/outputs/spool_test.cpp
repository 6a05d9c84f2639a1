// Bytes that wait in a file without a name come back as they were, and leave nothing.
#include "sim/outputs/spool.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace leviosim::outputs {
namespace {

std::string text_of(const Content& content) {
  std::string text;
  content.hand_to([&](std::string_view piece) { text += piece; });
  return text;
}

TEST(Spool, GivesItsBytesBackAsOftenAsAskedAndHasNoName) {
  const tests::Scratch folder;
  std::string all;
  {
    Spool spool(folder.path(), "a timeline");
    EXPECT_EQ(text_of(spool.content()), "");
    for (int i = 0; i < 30'000; ++i) {
      const std::string piece = std::to_string(i) + ' ';
      spool.add(piece);
      all += piece;
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_EQ(text_of(spool.content()), all);
    spool.add("and more");
    EXPECT_EQ(text_of(spool.content()), all + "and more");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace leviosim::outputs
