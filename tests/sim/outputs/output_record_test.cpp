#include "sim/outputs/output_record.h"

#include <fcntl.h>
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
  record.add("points.jsonl", {});
  const std::string text = record.text();
  EXPECT_EQ(text, "leviosim files 1\n" + kDigest + " 0 100%25 %0A%7F%FF r%C3%A9sum%C3%A9\n" +
                      kDigest + " 12 mav0/cam0/data.csv\n- - points.jsonl\n");
  const OutputRecord again = OutputRecord::parse(text, "f");
  EXPECT_EQ(again.text(), text);
  EXPECT_EQ(again.paths(), record.paths());
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
                                  std::string("leviosim journal 1 5\n"), std::string("\n")})
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

/// Writes the record, too.
void record_all(const fs::path& folder, const std::vector<std::string>& names) {
  write_text(folder / kRecordName, record_of(folder, names).text());
}

TEST(FolderContents, NameWhatIsForeign) {
  const Scratch folder;
  write_text(folder / "a", "1");
  write_text(folder / "deep/er/b", "2");
  record_all(folder.path(), {"a", "deep/er/b"});
  const auto foreign = [&] { return contents_of(folder.path()).foreign; };
  EXPECT_EQ(foreign(), "");
  const auto expect_foreign = [&](const std::string& name, auto make) {
    make(folder / name);
    EXPECT_EQ(foreign(), name);
    fs::remove_all(folder / name);
    EXPECT_EQ(foreign(), "");
  };
  expect_foreign("thesis.tex", [](const fs::path& p) { write_text(p, "x"); });
  expect_foreign("deep/thesis.tex", [](const fs::path& p) { write_text(p, "x"); });
  expect_foreign("deep/er/c", [](const fs::path& p) { fs::create_directory(p); });
  expect_foreign("link", [&](const fs::path& p) { fs::create_symlink(folder / "a", p); });
  expect_foreign("pipe", [](const fs::path& p) { ::mkfifo(p.c_str(), 0600); });
  fs::remove(folder / "a");  // a link to what it was is not what was written
  write_text(folder.path().string() + "-a", "1");
  fs::create_symlink(folder.path().string() + "-a", folder / "a");
  EXPECT_EQ(foreign(), "a");
  fs::remove(folder.path().string() + "-a");
}

/// A line may be short, and what is kept of it is not.
TEST(OutputRecord, OfMoreLinesThanAnyFlightHasFilesIsRefused) {
  const auto record_of_lines = [](int number) {
    std::string text = OutputRecord::header();
    for (int line = 1; line < number; ++line) text += "- - a\n";
    return text;
  };
  EXPECT_TRUE(OutputRecord::parse(record_of_lines(200'000), "f").names("a"));
  EXPECT_THROW(OutputRecord::parse(record_of_lines(200'001), "f"), InputError);
}

TEST(FolderContents, AnEditedFileIsNotLeviosimsAnyMore) {
  const Scratch folder;
  write_text(folder / "a", "1");
  const OutputRecord record = record_of(folder.path(), {"a"});
  record_all(folder.path(), {"a"});
  write_text(folder / "a", "2");  // of the same size
  EXPECT_FALSE(record.describes(folder.path(), "a"));
  EXPECT_EQ(contents_of(folder.path()).foreign, "a");
  EXPECT_TRUE(contents_of(folder.path(), true).is_ours());
  EXPECT_FALSE(record.is_complete(folder.path()));
  OutputRecord later = record;  // leviosim wrote both
  later.add("a", state_of_bytes("2"));
  EXPECT_TRUE(later.describes(folder.path(), "a"));
}

TEST(FolderContents, WhatHasNoDigestIsNotLeviosims) {
  const Scratch folder;
  write_text(folder / "points.jsonl", "1");
  write_text(folder / kRecordName, "leviosim files 1\n- - points.jsonl\n");
  EXPECT_TRUE(OutputRecord::read(folder.path())->names("points.jsonl"));
  EXPECT_EQ(contents_of(folder.path()).foreign, "points.jsonl");
}

TEST(FolderContents, UnfinishedFilesHaveTheirInodeForAName) {
  const Scratch folder;
  record_all(folder.path(), {});
  write_text(folder / "x", "half");
  const std::string name = unfinished_name(status_of(folder / "x").value());
  fs::rename(folder / "x", folder / name);
  write_text(folder / kUnnumbered, "");
  EXPECT_TRUE(contents_of(folder.path()).is_ours());
  write_text(folder / kUnnumbered, "mine");
  EXPECT_EQ(contents_of(folder.path()).foreign, kUnnumbered);
  fs::remove(folder / kUnnumbered);
  fs::copy(folder / name, folder / "copy");
  fs::rename(folder / "copy", folder / name);
  EXPECT_EQ(contents_of(folder.path()).foreign, name);
}

TEST(FolderContents, OfALargerSizeThanLeviosimWritesAreForeign) {
  const Scratch folder;
  write_text(folder / "a", "1");
  fs::resize_file(folder / "a", 100'000'000'000);
  write_text(folder / kRecordName,
             OutputRecord::header() + OutputRecord::line("a", {kDigest, 100'000'000'000}));
  EXPECT_EQ(contents_of(folder.path()).foreign, "a");
}

TEST(FolderContents, RemovesWhatIsOursAndNothingElse) {
  const Scratch folder;
  write_text(folder / "out/a", "1");
  write_text(folder / "out/deep/b", "2");
  record_all(folder / "out", {"a", "deep/b"});
  const FolderContents ours = contents_of(folder / "out");
  write_text(folder / "out/deep/mine", "3");
  ours.remove(Descriptor(::open((folder / "out").c_str(), O_RDONLY | O_DIRECTORY)));
  fs::remove(folder / "out" / kRecordName);
  EXPECT_EQ(tests::picture_of(folder.path()),
            (std::map<std::string, std::string>{
                {"out", "folder"}, {"out/deep", "folder"}, {"out/deep/mine", "file: 3"}}));
}

TEST(HeldRecord, IsNotWrittenThroughAnotherName) {
  const Scratch folder;
  write_text(folder / "mine", OutputRecord::header());
  fs::create_directory(folder / "out");
  fs::create_hard_link(folder / "mine", folder / "out" / kRecordName);
  EXPECT_THROW(add_to_record(folder / "out", "x", {kDigest, 1}), InputError);
  EXPECT_EQ(tests::read_text(folder / "mine"), OutputRecord::header());
}

}  // namespace
}  // namespace leviosim::outputs
