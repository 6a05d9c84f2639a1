#include "sim/outputs/output_folder.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <functional>

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

OutputRequest folder_request(const fs::path& path, bool replace = false) {
  return {.option = "--out", .path = path.string(), .replace = replace};
}

void expect_folder_refused(const OutputRequest& wanted, const std::vector<std::string>& parts) {
  expect_claim_refused<OutputFolder>(wanted, parts);
}

void write_results(const fs::path& path, const std::string& text, bool replace = false) {
  OutputFolder out(folder_request(path, replace));
  out.write("a", text);
  out.write("deep/b", "b");
  EXPECT_FALSE(out.commit());
}

/// In a process of its own, which is killed, or ends of itself with the status.
int in_child(const std::function<int()>& run) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(run());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(OutputFolder, AppearsWholeOrNotAtAll) {
  const Scratch folder;
  {
    OutputFolder out(folder_request(folder / "new/out/"));
    out.write("a", "1");
    EXPECT_FALSE(fs::exists(folder / "new/out"));
    EXPECT_FALSE(out.commit());
  }
  EXPECT_EQ(read_text(folder / "new/out/a"), "1");
  EXPECT_TRUE(contents_of(folder / "new/out").is_ours());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "new"), {}), 1);
  {
    OutputFolder out(folder_request(folder / "other/deep/out"));
    out.write("x/y", "1");
  }
  EXPECT_FALSE(fs::exists(folder / "other"));
}

/// Killed where the record grows, before it leads to a file's folders: none of them is there, so
/// the next run removes what was left.
TEST(OutputFolder, LeavesNoFolderThatItsRecordDoesNotLeadTo) {
  const Scratch folder;
  int killed = 0;
  for (rlim_t limit = 60; limit < 400; limit += 20) {
    const fs::path out_path = folder / std::to_string(limit);
    const int status = in_child([&] {
      ::signal(SIGXFSZ, SIG_DFL);
      const rlimit bytes{limit, limit};
      OutputFolder out(folder_request(out_path));
      ::setrlimit(RLIMIT_FSIZE, &bytes);
      out.write("a", "1");
      out.write("deep/er/b", "2");
      out.write("deep/est/c", "3");
      return 0;
    });
    killed += status == 128 + SIGXFSZ ? 1 : 0;
    if (status == 0) continue;
    write_results(out_path, "1");
    EXPECT_TRUE(contents_of(out_path).is_ours()) << limit;
  }
  EXPECT_GT(killed, 3);
}

TEST(OutputFolder, TakesAnEmptyFolderAndOneThroughALink) {
  const Scratch folder;
  fs::create_directory(folder / "real");
  fs::create_symlink("real", folder / "link");
  write_results(folder / "link", "1");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_text(folder / "real/a"), "1");
}

TEST(OutputFolder, ReplacesItsOwnIfAsked) {
  const Scratch folder;
  write_results(folder / "out", "1");
  expect_folder_refused(folder_request(folder / "out"),
                        {"--out", "exists and holds results", "--force"});
  {
    OutputFolder out(folder_request(folder / "out", true));
    out.write("c", "3");
    EXPECT_EQ(read_text(folder / "out/a"), "1");
    EXPECT_FALSE(out.commit());
  }
  const Picture left = picture_of(folder.path());
  EXPECT_EQ(left.count("out/a") + left.count("out/deep"), 0u);
  EXPECT_EQ(left.at("out/c"), "file: 3");
  EXPECT_EQ(left.size(), 3u);  // with the folder and the record
}

TEST(OutputFolder, RefusesWhatItDidNotWrite) {
  const Scratch folder;
  const auto expect_kept = [&](const std::string& name, const std::string& part) {
    const Picture before = picture_of(folder.path());
    for (const bool force : {false, true})
      expect_folder_refused(folder_request(folder / name, force), {part});
    EXPECT_EQ(picture_of(folder.path()), before);
  };
  write_text(folder / "foreign/manifest.json", "{}");
  expect_kept("foreign", "manifest.json");
  write_results(folder / "noted", "1");
  write_text(folder / "noted/deep/notes", "mine");
  expect_kept("noted", "deep/notes");
  write_results(folder / "edited", "1");
  write_text(folder / "edited/a", "2");
  expect_kept("edited", ": a,");
  write_results(folder / "linked", "1");
  fs::create_symlink("/etc/passwd", folder / "linked/link");
  expect_kept("linked", "link");
  write_text(folder / "file", "x");
  expect_kept("file", "is a file");
  expect_kept("file/below", "cannot be created");
  fs::create_symlink("nowhere", folder / "dangling");
  expect_kept("dangling", "leads nowhere");
  fs::create_symlink("loop", folder / "loop");
  expect_kept("loop", "cannot be used");
  write_text(folder / "broken/.leviosim-files", "what?\n");
  write_text(folder / "broken/x", "");
  expect_kept("broken", ".leviosim-files:1");
  expect_kept(std::string(300, 'x'), "too long");
  expect_folder_refused(folder_request(""), {"--out", "is empty"});
}

TEST(OutputFolder, NeverReplacesAnInput) {
  const Scratch folder;
  write_results(folder / "out", "1");
  OutputRequest wanted = folder_request(folder / "out", true);
  for (const char* input : {"out", "out/a", "out/deep/../deep", "link"}) {
    if (std::string(input) == "link") fs::create_symlink("out/deep", folder / "link");
    wanted.inputs = {folder / "none", folder / input};
    expect_folder_refused(wanted, {"holds", input, "is read"});
  }
  wanted.inputs = {folder / "none", {}, folder.path()};
  EXPECT_NO_THROW(OutputFolder{wanted});
}

TEST(OutputFolder, OneProcessAtATime) {
  const Scratch folder;
  const OutputFolder out(folder_request(folder / "out"));
  expect_folder_refused(folder_request(folder / "out"),
                        {"another leviosim is writing it", ".out.leviosim/.leviosim-files"});
  EXPECT_NO_THROW(OutputFolder(folder_request(folder / "other")));
}

TEST(OutputFolder, RemovesWhatADeadProcessLeft) {
  const Scratch folder;
  const auto die_while_writing = [&] {
    return in_child([&]() -> int {
      OutputFolder out(folder_request(folder / "out"));
      out.write("deep/b", "1");
      return ::kill(::getpid(), SIGKILL);
    });
  };
  ASSERT_EQ(die_while_writing(), 128 + SIGKILL);
  ASSERT_TRUE(fs::exists(folder / ".out.leviosim/deep/b"));
  write_results(folder / "out", "2");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
  EXPECT_EQ(read_text(folder / "out/deep/b"), "b");

  fs::remove_all(folder / "out");
  ASSERT_EQ(die_while_writing(), 128 + SIGKILL);
  write_text(folder / ".out.leviosim/deep/mine", "x");
  const Picture before = picture_of(folder.path());
  expect_folder_refused(folder_request(folder / "out"), {".out.leviosim", "deep/mine", "by hand"});
  EXPECT_EQ(picture_of(folder.path()), before);
}

TEST(OutputFolder, AFolderOfTheHiddenNameIsNotTouched) {
  const Scratch folder;
  write_text(folder / ".out.leviosim/mine", "x");
  write_text(folder / ".file.leviosim", "x");
  fs::create_symlink(folder.path(), folder / ".link.leviosim");
  const Picture before = picture_of(folder.path());
  expect_folder_refused(folder_request(folder / "out"), {".out.leviosim", "mine"});
  expect_folder_refused(folder_request(folder / "file"), {".file.leviosim", "in the way"});
  expect_folder_refused(folder_request(folder / "link"), {".link.leviosim", "in the way"});
  EXPECT_EQ(picture_of(folder.path()), before);
}

TEST(OutputFolder, WhatAppearsMeanwhileStaysAndTheResultsGoBeside) {
  for (const bool force : {false, true}) {
    const Scratch folder;
    OutputFolder out(folder_request(folder / "out", force));
    out.write("a", "1");
    write_text(folder / "out/precious", "x");
    write_text(folder / "out-2", "taken");
    const std::optional<std::string> why = out.commit();
    ASSERT_TRUE(why);
    EXPECT_NE(why->find("out-3"), std::string::npos) << *why;
    EXPECT_EQ(out.shown_path(), (folder / "out-3").string());
    EXPECT_EQ(read_text(folder / "out/precious"), "x");
    EXPECT_EQ(read_text(folder / "out-2"), "taken");
    EXPECT_EQ(read_text(folder / "out-3/a"), "1");
  }
}

TEST(OutputFolder, NotesPutIntoOldResultsMeanwhileStay) {
  const Scratch folder;
  write_results(folder / "out", "1");
  {
    OutputFolder out(folder_request(folder / "out", true));
    out.write("a", "2");
    write_text(folder / "out/notes", "x");
    EXPECT_TRUE(out.commit());
  }
  EXPECT_EQ(read_text(folder / "out/notes"), "x");
  EXPECT_EQ(read_text(folder / "out/a"), "1");
  EXPECT_EQ(read_text(folder / "out-2/a"), "2");
}

TEST(OutputFolder, ExchangesInStepsWhereTheFileSystemCannot) {
  const Scratch folder;
  write_text(folder / "a/x", "1");
  write_text(folder / "b/y", "2");
  write_text(folder / "b-2", "in the way");
  EXPECT_EQ(exchange_by_steps(folder / "a", folder / "b"), 0);
  EXPECT_EQ(read_text(folder / "a/y"), "2");
  EXPECT_EQ(read_text(folder / "b/x"), "1");
  EXPECT_EQ(exchange(folder / "a", folder / "b"), 0);
  EXPECT_EQ(read_text(folder / "a/x"), "1");
  EXPECT_EQ(exchange_by_steps(folder / "none", folder / "b"), ENOENT);
  EXPECT_EQ(read_text(folder / "b/y"), "2");
  EXPECT_EQ(read_text(folder / "b-2"), "in the way");
}

TEST(OutputFolder, AFullDiskIsToldAtOnce) {
  const Scratch folder;
  fs::create_directory(folder / "small");
  if (::mount("none", (folder / "small").c_str(), "tmpfs", 0, "size=128k") != 0)
    GTEST_SKIP() << "no file system of its own can be mounted here";
  expect_folder_refused(folder_request(folder / "small/out"),
                        {(folder / "small/out").string() + ":", "No space left on device"});
  expect_folder_refused(folder_request(folder / "small"), {"choose a folder in it"});
  EXPECT_TRUE(fs::is_empty(folder / "small"));
  ::umount((folder / "small").c_str());
}

}  // namespace
}  // namespace leviosim::outputs
