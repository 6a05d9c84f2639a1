// Sweeps that a stranger made: what lies beside the data base, and what its schema says, deletes
// nothing, keeps nobody waiting, and takes no memory.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <csignal>
#include <thread>

#include "tests/support/program_suite.h"
#include "tests/support/scratch.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::Program;
using testing::ProgramLimits;
using testing::ProgramResult;
using tests::picture_of;
using tests::read_text;
using tests::write_text;

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

const std::string kMagic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";

/// A hot journal without pages that names a file as its super-journal (SQLite's file format).
std::string journal_naming(const std::string& victim) {
  std::string header = kMagic + big_endian(0) + big_endian(1) + big_endian(0xffffff) +
                       big_endian(512) + big_endian(4096);
  header.resize(512, '\0');
  std::uint32_t sum = 0;
  for (const char c : victim) sum += static_cast<std::uint32_t>(c);
  const auto size = static_cast<std::uint32_t>(victim.size());
  return header + big_endian((1u << 30) / 4096 + 1) + victim + big_endian(size) + big_endian(sum) +
         kMagic;
}

/// Files of SQL in, as somebody with the sqlite3 program would.
void change(const fs::path& folder, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "sweep.sqlite").c_str(), &database), SQLITE_OK);
  char* fault = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &fault), SQLITE_OK) << fault;
  sqlite3_close(database);
}

class HostileSweeps : public tests::ProgramSuite {
 protected:
  static void SetUpTestSuite() {
    make_folder("hostile-sweeps");
    traces::write_synthetic_flight(path("flight"), {.duration_s = 0.5, .texel_m = 0.05});
    expect_done({"run", "--platform", "gap9", "--data", path("flight"), "--record", "--out",
                 path("recorded"), "--quiet"});
    write_text(path("plan.yaml"),
               "base: { trace: recorded }\n"
               "points: { grid: { platform.cluster.clock: [200, 370] } }\n");
    write_text(path("budgets.yaml"), "budgets: [{ limits: [L1 peak <= 1 MB] }]\n");
    expect_done(sweep("clean"));
  }
  void SetUp() override {
    fs::copy(path("clean"), path("sw"));
    write_text(path("thesis.tex"), "mine");
  }
  void TearDown() override {
    fs::remove_all(path("sw"));
    fs::remove_all(path("all"));
  }

  static std::vector<std::string> sweep(const std::string& out, const std::string& further = {}) {
    std::vector<std::string> words{"sweep",   path("plan.yaml"), "--out",      path(out),
                                   "--quiet", "--cache",         path("cache")};
    if (!further.empty()) words.push_back(further);
    return words;
  }
  static std::vector<std::vector<std::string>> readers() {
    std::vector<std::string> budget = sweep("sw", "--budget");
    budget.push_back(path("budgets.yaml"));
    return {{"compare", path("sw") + ":1", path("sw") + ":2", "--quiet"},
            sweep("sw"),
            sweep("sw", "--force"),
            budget,
            {"sweep", "--merge", path("all"), path("sw"), path("clean")},
            {"sweep", "--merge", path("sw"), path("clean"), path("clean")}};
  }
  static ProgramResult limited(const std::vector<std::string>& words) {
    return Program(folder_->path(), words, {.cpu_seconds = 10, .data_bytes = 400'000'000}).wait();
  }
  /// Every command that opens the data base refuses it, soon, and changes nothing.
  static void expect_refused_by_all(const std::vector<std::string>& parts) {
    for (const std::vector<std::string>& words : readers()) {
      fs::remove_all(path("all"));
      const auto before = picture_of(path("sw"));
      const ProgramResult result = limited(words);
      EXPECT_EQ(read_text(path("thesis.tex")), "mine") << words[0] << ' ' << words.back();
      if (words[1] == "--merge" && words[2] == path("all"))
        EXPECT_EQ(result.status, 2) << result.err;
      else
        expect_refused(result, parts);
      EXPECT_EQ(picture_of(path("sw")), before) << words[0] << ' ' << words.back();
      write_text(path("thesis.tex"), "mine");
    }
  }
};

TEST_F(HostileSweeps, JournalsThatNameAnotherFileDeleteNothing) {
  write_text(path("sw/sweep.sqlite-journal"), journal_naming(path("thesis.tex")));
  expect_refused_by_all({"sweep.sqlite", "names another file"});
}

TEST_F(HostileSweeps, WhatIsNoJournalIsNotOpened) {
  for (const char* end : {"-wal", "-shm"}) {
    write_text(path("sw/sweep.sqlite") + end, "x");
    expect_refused_by_all({"sweep.sqlite", end});
    fs::remove(path("sw/sweep.sqlite") + end);
  }
  ASSERT_EQ(::mkfifo((path("sw/sweep.sqlite-journal")).c_str(), 0600), 0);
  for (const std::vector<std::string>& words : readers()) {
    Program program(folder_->path(), words);
    for (int tries = 0; tries < 500 && program.running(); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(program.running()) << words[0] << " waits for a FIFO";
    program.send(SIGKILL);
    EXPECT_EQ(program.wait().status, 2);
  }
}

TEST_F(HostileSweeps, FilesOfOtherNamesAreNotWritten) {
  fs::create_hard_link(path("sw/sweep.sqlite"), path("elsewhere"));
  expect_refused_by_all({"sweep.sqlite", "one name"});
  fs::remove(path("elsewhere"));
}

TEST_F(HostileSweeps, SchemasOfOthersAreNotRun) {
  const std::string kEndless =
      "WITH RECURSIVE n(point, key) AS (SELECT 1, 'x' UNION ALL SELECT point + 1, key FROM n) "
      "SELECT point, key FROM n";
  for (const std::string& sql : std::vector<std::string>{
           "ALTER TABLE planned RENAME TO was; CREATE VIEW planned AS " + kEndless,
           "CREATE TRIGGER t AFTER INSERT ON sweep BEGIN INSERT INTO front SELECT 1 FROM (" +
               kEndless + "); END; UPDATE sweep SET value = '' WHERE name = 'plan file'",
           "ALTER TABLE sweep RENAME TO was; CREATE VIEW sweep AS SELECT name, "
           "printf('%.*c', 900000000, 'x') AS value FROM was",
           "CREATE INDEX i ON sweep(printf('%.*c', 100000, value))",
           "DROP VIEW points; CREATE VIEW points AS SELECT 1 AS point, 'done' AS status, '' AS "
           "failure, key FROM (" +
               kEndless + ")"}) {
    change(path("sw"), "PRAGMA writable_schema = 0;" + sql);
    for (const std::vector<std::string>& words : readers()) {
      const auto before = picture_of(path("sw"));
      const ProgramResult result = limited(words);
      EXPECT_EQ(result.status, 2) << sql << '\n' << words[0] << ' ' << words.back() << result.err;
      EXPECT_EQ(picture_of(path("sw")), before);
      fs::remove_all(path("all"));
    }
    fs::remove_all(path("sw"));
    fs::copy(path("clean"), path("sw"));
  }
}

TEST_F(HostileSweeps, ForceEmptiesNoDataBaseOfOthers) {
  fs::remove_all(path("sw"));
  fs::create_directory(path("sw"));
  change(path("sw"),
         "CREATE TABLE sweep(room TEXT); INSERT INTO sweep VALUES('kitchen');"
         "CREATE TABLE planned(day TEXT); CREATE TABLE outcomes(dust REAL)");
  const auto before = picture_of(path("sw"));
  expect_refused(limited(sweep("sw", "--force")), {"sweep.sqlite"});
  EXPECT_EQ(picture_of(path("sw")), before);
}

TEST_F(HostileSweeps, LaterVersionsAreNotGoneOnWith) {
  change(path("sw"), "UPDATE sweep SET value = 'leviosim sweep 99' WHERE name = 'format'");
  expect_refused(limited(sweep("sw")), {"version", "leviosim sweep 2"});
}

}  // namespace
}  // namespace leviosim::tools
