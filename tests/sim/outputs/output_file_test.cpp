#include "sim/outputs/output_file.h"

#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "tests/sim/outputs/output_claims.h"
#include "tests/support/scratch.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;
using tests::picture_of;
using tests::read_text;
using tests::Scratch;
using tests::write_text;
using Picture = std::map<std::string, std::string>;

OutputRequest file_request(const fs::path& path, bool replace = false) {
  return {.option = "--json", .path = path.string(), .replace = replace};
}

void expect_file_refused(const OutputRequest& wanted, const std::vector<std::string>& parts) {
  expect_claim_refused<OutputFile>(wanted, parts);
}

std::optional<std::string> write(const OutputRequest& wanted, const std::string& text) {
  return OutputFile(wanted).publish(text);
}

TEST(OutputFile, AppearsWholeAndIsRecorded) {
  const Scratch folder;
  {
    OutputFile out(file_request(folder / "f.json"));
    EXPECT_TRUE(fs::is_empty(folder.path()));
    EXPECT_FALSE(out.publish("1"));
  }
  EXPECT_FALSE(write(file_request(folder / "g.json"), "2"));
  EXPECT_EQ(read_text(folder / "f.json"), "1");
  EXPECT_EQ(picture_of(folder.path()).size(), 3u);
  EXPECT_TRUE(contents_of(folder.path()).is_ours());
}

TEST(OutputFile, ReplacesItsOwnIfAskedAndNothingElse) {
  const Scratch folder;
  ASSERT_FALSE(write(file_request(folder / "f.json"), "1"));
  expect_file_refused(file_request(folder / "f.json"), {"--json", "exists", "--force"});
  ASSERT_FALSE(write(file_request(folder / "f.json", true), "2"));
  ASSERT_FALSE(write(file_request(folder / "f.json", true), "1"));
  EXPECT_EQ(read_text(folder / "f.json"), "1");
  EXPECT_EQ(picture_of(folder.path()).size(), 2u);
  write_text(folder / "f.json", "3");
  write_text(folder / "mine", "1");  // as leviosim wrote f.json
  fs::create_directory(folder / "dir");
  fs::create_symlink("nowhere", folder / "dangling");
  fs::create_symlink("mine", folder / "link");
  const Picture before = picture_of(folder.path());
  for (const bool force : {false, true}) {
    expect_file_refused(file_request(folder / "f.json", force), {"changed since"});
    expect_file_refused(file_request(folder / "mine", force), {"not a file that leviosim wrote"});
    expect_file_refused(file_request(folder / "link", force), {"not a file that leviosim wrote"});
    expect_file_refused(file_request(folder / "dir", force), {"is a folder"});
    expect_file_refused(file_request(folder / "new/", force), {"is a folder"});
    expect_file_refused(file_request(folder / "dangling", force), {"leads nowhere"});
    expect_file_refused(file_request(folder / "none/f", force), {"no folder"});
    expect_file_refused(file_request(folder / ".leviosim-files", force), {"is the record"});
    expect_file_refused(file_request("/dev/null", force), {"no regular file"});
    expect_file_refused(file_request("", force), {"is empty"});
  }
  EXPECT_EQ(picture_of(folder.path()), before);
}

TEST(OutputFile, NeverReplacesAnInput) {
  const Scratch folder;
  ASSERT_FALSE(write(file_request(folder / "f.json"), "1"));
  OutputRequest wanted = file_request(folder / "f.json", true);
  for (const fs::path& input : {folder / "f.json", folder.path(), folder / "../" / folder.path()}) {
    wanted.inputs = {input};
    expect_file_refused(wanted, {"is read"});
  }
  wanted.path = (folder / "new.json").string();  // beside what is read
  EXPECT_FALSE(write(wanted, "2"));
}

TEST(OutputFile, WhatAppearsMeanwhileStays) {
  for (const bool force : {false, true}) {
    const Scratch folder;
    OutputFile out(file_request(folder / "f.json", force));
    write_text(folder / "f.json", "precious");
    write_text(folder / "f-2.json", "taken");
    const std::optional<std::string> why = out.publish("1");
    ASSERT_TRUE(why);
    EXPECT_NE(why->find("f-3.json"), std::string::npos) << *why;
    EXPECT_EQ(read_text(folder / "f.json"), "precious");
    EXPECT_EQ(read_text(folder / "f-2.json"), "taken");
    EXPECT_EQ(read_text(folder / "f-3.json"), "1");
    EXPECT_EQ(picture_of(folder.path()).size(), 4u);
  }
}

TEST(OutputFile, TheHiddenNameIsNotTouchedUnlessLeviosimWroteIt) {
  const Scratch folder;
  write_text(folder / ".f.json.leviosim", "x");
  const Picture before = picture_of(folder.path());
  expect_file_refused(file_request(folder / "f.json"), {".f.json.leviosim", "in the way"});
  EXPECT_EQ(picture_of(folder.path()), before);
}

TEST(OutputFile, ARecordIsAddedToNotReplaced) {
  const Scratch folder;
  write_text(folder / "x", "1");
  add_to_record(folder.path(), "x", state_of_bytes("1"));
  add_to_record(folder.path(), "x", state_of_bytes("1"));
  ASSERT_FALSE(write(file_request(folder / "y"), "2"));
  const OutputRecord record = OutputRecord::read(folder.path()).value();
  EXPECT_EQ(record.paths(), (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(OutputRecord::parse(read_text(folder / kRecordName), "f").text(),
            read_text(folder / kRecordName));
}

}  // namespace
}  // namespace leviosim::outputs
