#include "sim/outputs/output_record.h"

#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "tests/support/scratch.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;
using tests::Scratch;
using tests::write_text;

const std::string kDigest(64, 'a');

OutputRecord record_of(const fs::path& folder, const std::vector<std::string>& names) {
  OutputRecord record;
  for (const std::string& name : names) record.add(name, state_of_file(folder / name).value());
  return record;
}

TEST(OutputRecord, IsReadAsItWasWritten) {
  OutputRecord record;
  record.add("mav0/cam0/data.csv", {kDigest, 12});
  record.add("100% \n\x7f\xff r\xc3\xa9sum\xc3\xa9", {kDigest, 0});
  record.add("sweep.sqlite", {});
  const std::string text = record.text();
  EXPECT_EQ(text, "leviosim files 1\n" + kDigest + " 0 100%25 %0A%7F%FF r%C3%A9sum%C3%A9\n" +
                      kDigest + " 12 mav0/cam0/data.csv\n- - sweep.sqlite\n");
  const OutputRecord again = OutputRecord::parse(text, "f");
  EXPECT_EQ(again.text(), text);
  EXPECT_EQ(again.paths(), record.paths());
  EXPECT_EQ(OutputRecord::parse(OutputRecord::journal_header(), "f").process(), ::getpid());
}

TEST(OutputRecord, WhatAKillCutOffDoesNotCount) {
  const std::string whole = "leviosim files 1\n" + kDigest + " 12 a\n" + kDigest + " 12 b\n";
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const OutputRecord record = OutputRecord::parse(whole.substr(0, size), "f");
    EXPECT_EQ(record.names("b"), size == whole.size());
  }
}

TEST(OutputRecord, RefusesWhatIsNoRecord) {
  for (const std::string& text : {std::string("{}\n"), std::string("leviosim files 2\n"),
                                  std::string("leviosim journal 1 x\n"),
                                  std::string("leviosim journal 1 -3\n"), std::string("\n")})
    EXPECT_THROW(OutputRecord::parse(text, "f"), InputError) << text;
  const std::vector<std::string> lines{"a",
                                       "D 12",
                                       "D 12 ",
                                       "D 12 ../a",
                                       "D 12 /a",
                                       "D 12 a//b",
                                       "D 12 a/",
                                       "D 12 ./a",
                                       "D 12 a/..",
                                       "D 12 %00",
                                       "D 12 %4",
                                       "D 12 %zz",
                                       "D -1 a",
                                       "D  a",
                                       "D 99999999999999999999 a",
                                       "- 3 a",
                                       "D - a",
                                       "E 1 a",
                                       "DD 1 a",
                                       "D 12 .leviosim-files",
                                       "D 12 %2e%2e/a"};
  for (std::string line : lines) {
    if (line[0] == 'D') line.replace(0, 1, kDigest);
    if (line[0] == 'E') line.replace(0, 1, std::string(64, 'A'));
    EXPECT_THROW(OutputRecord::parse("leviosim files 1\n" + line + "\n", "f"), InputError) << line;
  }
}

TEST(OutputRecord, NamesWhatIsForeign) {
  const Scratch folder;
  write_text(folder / "a", "1");
  write_text(folder / "deep/er/b", "2");
  const OutputRecord record = record_of(folder.path(), {"a", "deep/er/b"});
  write_text(folder / kRecordName, record.text());
  EXPECT_EQ(record.first_foreign(folder.path()), "");
  const auto expect_foreign = [&](const std::string& name, auto make) {
    make(folder / name);
    EXPECT_EQ(record.first_foreign(folder.path()), name);
    fs::remove_all(folder / name);
    EXPECT_EQ(record.first_foreign(folder.path()), "");
  };
  expect_foreign("thesis.tex", [](const fs::path& p) { write_text(p, "x"); });
  expect_foreign("deep/thesis.tex", [](const fs::path& p) { write_text(p, "x"); });
  expect_foreign("deep/er/c", [](const fs::path& p) { fs::create_directory(p); });
  expect_foreign("link", [&](const fs::path& p) { fs::create_symlink(folder / "a", p); });
  expect_foreign("pipe", [](const fs::path& p) { ::mkfifo(p.c_str(), 0600); });
  fs::remove(folder / "a");  // a link to what it was is not what was written
  write_text(folder.path().string() + "-a", "1");
  fs::create_symlink(folder.path().string() + "-a", folder / "a");
  EXPECT_EQ(record.first_foreign(folder.path()), "a");
  fs::remove(folder.path().string() + "-a");
}

TEST(OutputRecord, AnEditedFileIsNotLeviosimsAnyMore) {
  const Scratch folder;
  write_text(folder / "a", "1");
  const OutputRecord record = record_of(folder.path(), {"a"});
  write_text(folder / "a", "2");  // of the same size
  EXPECT_FALSE(record.describes(folder.path(), "a"));
  EXPECT_EQ(record.first_foreign(folder.path()), "a");
  EXPECT_EQ(record.first_foreign(folder.path(), true), "");
  EXPECT_FALSE(record.is_complete(folder.path()));
  OutputRecord later = record;  // leviosim wrote both
  later.add("a", state_of_bytes("2"));
  EXPECT_TRUE(later.describes(folder.path(), "a"));
}

TEST(OutputRecord, WhatHasNoDigestIsOnlyRemovedFromAJournal) {
  const Scratch folder;
  write_text(folder / "sweep.sqlite", "1");
  const OutputRecord record = OutputRecord::parse("leviosim files 1\n- - sweep.sqlite\n", "f");
  EXPECT_TRUE(record.names("sweep.sqlite"));
  EXPECT_EQ(record.first_foreign(folder.path()), "sweep.sqlite");
  const OutputRecord journal = OutputRecord::parse("leviosim journal 1 5\n- - sweep.sqlite\n", "f");
  EXPECT_EQ(journal.first_foreign(folder.path()), "");
}

TEST(OutputRecord, RemovesWhatItNamesAndNothingElse) {
  const Scratch folder;
  write_text(folder / "out/a", "1");
  write_text(folder / "out/deep/b", "2");
  const OutputRecord record = record_of(folder / "out", {"a", "deep/b"});
  write_text(folder / "out/deep/mine", "3");
  record.remove_from(folder / "out");
  EXPECT_EQ(tests::picture_of(folder.path()),
            (std::map<std::string, std::string>{
                {"out", "folder"}, {"out/deep", "folder"}, {"out/deep/mine", "file: 3"}}));
}

}  // namespace
}  // namespace leviosim::outputs
